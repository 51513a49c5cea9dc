// SPDX-License-Identifier: Apache-2.0
#include "study/pareto.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "study/grouped.h"

namespace controlspace {
namespace {

constexpr const char* costs[] = {"bytes_total", "t_access_ns_random"};
constexpr const char* errors[] = {"delta_R_fine_max", "delta_R_fine_mean"};

/// The first or third quartile of a cost that has them, or the cost.
double bound(const Row& row, const std::string& cost, const char* quartile) {
    const double x = row.number(cost + quartile);
    return std::isnan(x) ? row.number(cost) : x;
}

void mark_front(ParetoPlot& plot, std::span<const Row> rows) {
    for (ParetoPoint& p : plot.points) {
        const double low = bound(rows[p.row], plot.cost, "_q1");
        const auto is_better = [&](const ParetoPoint& q) {
            return rows[q.row].is_ranked() &&
                   ((q.error <= p.error && bound(rows[q.row], plot.cost, "_q3") < low) ||
                    (q.error < p.error && q.cost == p.cost));
        };
        p.on_front = rows[p.row].is_ranked() && std::ranges::none_of(plot.points, is_better);
    }
}

}  // namespace

std::vector<ParetoPlot> pareto_plots(std::span<const Row> rows,
                                     std::span<const CaseParameter> parameters) {
    std::vector<ParetoPlot> plots;
    const auto label = [&](const Row& row) { return work_label(row.setting, parameters); };
    for (auto [work, members] : grouped(rows, label)) {
        std::erase_if(members,
                      [](const Row* row) { return !std::isfinite(row->number(errors[0])); });
        if (members.size() < 2) continue;
        for (const char* cost : costs) {
            for (const char* error : errors) {
                ParetoPlot& plot = plots.emplace_back(ParetoPlot{work, cost, error, {}});
                for (const Row* row : members) {
                    plot.points.push_back({static_cast<std::size_t>(row - rows.data()),
                                           row->number(cost), row->number(error)});
                }
                mark_front(plot, rows);
            }
        }
    }
    return plots;
}

std::string pareto_json(std::span<const Row> rows, std::span<const CaseParameter> parameters) {
    using Json = nlohmann::ordered_json;
    Json json = Json::array();
    for (const ParetoPlot& plot : pareto_plots(rows, parameters)) {
        Json points = Json::array();
        for (const ParetoPoint& p : plot.points) {
            points.push_back({{"label", method_label(rows[p.row].setting, parameters)},
                              {"cost", p.cost},
                              {"error", p.error},
                              {"front", p.on_front}});
        }
        json.push_back({{"work", plot.work},
                        {"cost", plot.cost},
                        {"error", plot.error},
                        {"points", std::move(points)}});
    }
    return json.dump(1) + "\n";
}

std::vector<TextTable> pareto_tables(std::span<const Row> rows,
                                     std::span<const CaseParameter> parameters) {
    std::vector<TextTable> tables;
    const auto plots = pareto_plots(rows, parameters);
    // All four plots of a work have its points in the same order.
    for (auto plot = plots.begin(); plot != plots.end(); plot += 4) {
        const auto& by_bytes = plot[0].points;
        const auto& by_access = plot[2].points;
        TextTable& table = tables.emplace_back(
            TextTable{"On a front: " + plot->work,
                      "No other row is as accurate (largest δ_R at the finer probes) and smaller "
                      "(memory), or faster at random places beyond the quartiles of its samples "
                      "(access).",
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
        std::ranges::stable_sort(order, {}, [&](std::size_t i) { return by_bytes[i].error; });
        for (const std::size_t i : order) {
            const bool both = by_bytes[i].on_front && by_access[i].on_front;
            table.rows.push_back({method_label(rows[by_bytes[i].row].setting, parameters),
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
