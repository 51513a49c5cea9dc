#include "study/pareto.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

namespace controlspace {
namespace {

constexpr std::pair<ParetoCost, std::string_view> costs[] = {
    {ParetoCost::bytes, "bytes_total"}, {ParetoCost::access, "t_access_ns_random"}};
constexpr std::pair<ParetoError, std::string_view> errors[] = {
    {ParetoError::max, "delta_R_fine_max"}, {ParetoError::mean, "delta_R_fine_mean"}};

template <class Key, std::size_t n>
std::string_view name_of(Key key, const std::pair<Key, std::string_view> (&names)[n]) {
    return std::find_if(names, names + n, [&](const auto& name) { return name.first == key; })
        ->second;
}

double cost_of(ParetoCost cost, const Measures& m) {
    return cost == ParetoCost::bytes ? static_cast<double>(m.footprint.bytes_total())
                                     : m.access_random.median_ns();
}

double error_of(ParetoError error, const Measures& m) {
    return error == ParetoError::max ? m.accuracy_fine.max : m.accuracy_fine.mean;
}

void mark_front(std::vector<ParetoPoint>& points) {
    for (ParetoPoint& p : points) {
        p.on_front = std::none_of(points.begin(), points.end(), [&](const ParetoPoint& q) {
            return q.cost <= p.cost && q.error <= p.error && (q.cost < p.cost || q.error < p.error);
        });
    }
}

/// Works in the order of their first rows, with the measured rows of each.
std::vector<std::pair<std::string, std::vector<std::size_t>>> works(std::span<const Row> rows) {
    std::vector<std::pair<std::string, std::vector<std::size_t>>> found;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (!rows[i].measures || !std::isfinite(rows[i].measures->accuracy_fine.max)) continue;
        const std::string label = work_label(rows[i].setting);
        auto work = std::find_if(found.begin(), found.end(),
                                 [&](const auto& known) { return known.first == label; });
        if (work == found.end()) work = found.insert(found.end(), {label, {}});
        work->second.push_back(i);
    }
    std::erase_if(found, [](const auto& work) { return work.second.size() < 2; });
    return found;
}

}  // namespace

std::string pareto_label(const Case& c) {
    std::string label = structure_label(c);
    if (!c.target_delta && c.tau != Case().tau) label += fmt::format(", tau {}", c.tau);
    return label;
}

std::vector<ParetoPlot> pareto_plots(std::span<const Row> rows) {
    std::vector<ParetoPlot> plots;
    for (const auto& [work, members] : works(rows)) {
        for (const auto& [cost, cost_name] : costs) {
            for (const auto& [error, error_name] : errors) {
                ParetoPlot& plot = plots.emplace_back(ParetoPlot{work, cost, error, {}});
                for (const std::size_t row : members) {
                    const Measures& m = *rows[row].measures;
                    plot.points.push_back({row, cost_of(cost, m), error_of(error, m)});
                }
                mark_front(plot.points);
            }
        }
    }
    return plots;
}

std::string pareto_json(std::span<const Row> rows) {
    using Json = nlohmann::ordered_json;
    Json json = Json::array();
    for (const ParetoPlot& plot : pareto_plots(rows)) {
        Json points = Json::array();
        for (const ParetoPoint& p : plot.points) {
            points.push_back({{"label", pareto_label(rows[p.row].setting)},
                              {"cost", p.cost},
                              {"error", p.error},
                              {"front", p.on_front}});
        }
        json.push_back({{"work", plot.work},
                        {"cost", name_of(plot.cost, costs)},
                        {"error", name_of(plot.error, errors)},
                        {"points", std::move(points)}});
    }
    return json.dump(1) + "\n";
}

std::vector<TextTable> pareto_tables(std::span<const Row> rows) {
    std::vector<TextTable> tables;
    const auto plots = pareto_plots(rows);
    // All four plots of a work have its points in the same order.
    for (auto plot = plots.begin(); plot != plots.end(); plot += 4) {
        const auto& by_bytes = plot[0].points;
        const auto& by_access = plot[2].points;
        TextTable& table = tables.emplace_back(
            TextTable{"On a front: " + plot->work,
                      "No other row is as accurate (largest δ_R at the finer probes) and smaller "
                      "(memory), or as fast at random places (access).",
                      {{"structure", Align::left},
                       {"MB"},
                       {"random ns"},
                       {"fine max"},
                       {"front of", Align::left}},
                      {}});
        std::vector<std::size_t> order;
        for (std::size_t i = 0; i < by_bytes.size(); ++i) {
            if (by_bytes[i].on_front || by_access[i].on_front) order.push_back(i);
        }
        std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
            return by_bytes[a].error < by_bytes[b].error;
        });
        for (const std::size_t i : order) {
            const bool both = by_bytes[i].on_front && by_access[i].on_front;
            table.rows.push_back({pareto_label(rows[by_bytes[i].row].setting),
                                  fmt::format("{:.2f}", by_bytes[i].cost / 1e6),
                                  fmt::format("{:.1f}", by_access[i].cost),
                                  fmt::format("{:.4f}", by_bytes[i].error),
                                  both                   ? "memory, access"
                                  : by_bytes[i].on_front ? "memory"
                                                         : "access"});
        }
    }
    return tables;
}

}  // namespace controlspace
