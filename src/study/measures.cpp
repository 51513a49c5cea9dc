#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "controlspace/metric/nonconformity.h"
#include "controlspace/study/measure.h"

namespace controlspace {
namespace {

using Samples = std::vector<double>;

template <class Number>
MeasuredValue count(Number number) {
    return static_cast<std::int64_t>(number);
}

/// A row of a number that counts something.
template <class Get>
Measure counted(const char* key, const char* unit, Get get, Column column = {}) {
    return {key, unit, [get](const Finished& f) { return count(get(f)); }, std::move(column)};
}

/// A row of a number that a member of Finished has.
template <class Part, class Number>
Measure real(const char* key, Part Finished::*part, Number Part::*number, Column column = {}) {
    return {key, "", [=](const Finished& f) -> MeasuredValue { return f.*part.*number; },
            std::move(column)};
}

std::vector<Measure> size_rows() {
    return {
        counted("sources_inserted", "",
                [](const Finished& f) { return f.creation.sources_inserted; }),
        counted("tree_nodes", "", [](const Finished& f) { return f.footprint.tree_nodes; }),
        counted("cells", "", [](const Finished& f) { return f.footprint.cells; }, {"cells", "{}"}),
        counted("control_nodes", "", [](const Finished& f) { return f.footprint.control_nodes; }),
        counted("depth", "", [](const Finished& f) { return f.footprint.depth; }),
        counted("bytes_total", "byte", [](const Finished& f) { return f.footprint.bytes_total(); },
                {"MB", "{:.2f}", 1e-6}),
        counted("bytes_payload", "byte",
                [](const Finished& f) { return f.footprint.bytes_payload; }),
        counted("bytes_topology", "byte",
                [](const Finished& f) { return f.footprint.bytes_topology; }),
        counted("bytes_auxiliary", "byte",
                [](const Finished& f) { return f.footprint.bytes_auxiliary; }),
    };
}

std::vector<Measure> time_rows() {
    std::vector<Measure> rows;
    const auto add = [&](const char* key, const char* unit, auto samples, const Column& column) {
        const auto more = sampled_measure(key, unit, samples, column);
        rows.insert(rows.end(), more.begin(), more.end());
    };
    add("t_insert_s", "s", [](const Finished& f) { return f.creation.insert_s; }, {});
    add("t_gradation_s", "s", [](const Finished& f) { return f.creation.gradation_s; }, {});
    add("t_creation_s", "s",
        [](const Finished& f) {
            Samples sums = f.creation.insert_s;
            for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += f.creation.gradation_s[i];
            return sums;
        },
        {"creation s", "{:.3f}"});
    add("t_access_ns_random", "ns", [](const Finished& f) { return f.access_random.samples_ns; },
        {"random ns", "{:.1f}", 1, "fastest access at random places"});
    add("t_access_ns_grid", "ns", [](const Finished& f) { return f.access_grid.samples_ns; },
        {"grid ns", "{:.1f}", 1, "fastest access in grid order"});
    add("t_access_ns_single", "ns", [](const Finished& f) { return f.access_single.samples_ns; },
        {"single ns", "{:.1f}"});
    rows.push_back(counted("access_batch", "", [](const Finished& f) { return f.access_batch; }));
    return rows;
}

/// What the probes found beyond the error that the remark states; empty where it is nothing.
std::string found_by_probes(const Finished& f) {
    if (f.creation.within == 0 || f.setting.reference != &exact_reference_kind()) return "";
    constexpr double rounding = 1e-4;  // of the factor in the remark
    const double found = std::max(f.accuracy.within(), f.accuracy_fine.within());
    const double delta = std::max(f.accuracy.max, f.accuracy_fine.max);
    const double rest = 1 + rounding + f.study.reference_tolerance;
    // δ as a factor of lengths, so that the tolerance means the same.
    if (found <= f.creation.within * rest &&
        largest_factor_within(delta) <= largest_factor_within(f.creation.delta) * rest) {
        return "";
    }
    return fmt::format("; the probes found more: δ {:.4g}, lengths within {:.4g}x", delta, found);
}

std::vector<Measure> accuracy_rows() {
    using F = Finished;
    return {
        {"delta_S_max", "", [](const Finished& f) { return f.source_accuracy; }},
        real("delta_R_max", &F::accuracy, &Accuracy::max, {"δ_R max", "{:.4f}"}),
        real("delta_R_mean", &F::accuracy, &Accuracy::mean, {"δ_R mean", "{:.4f}"}),
        real("delta_R_p95", &F::accuracy, &Accuracy::p95),
        real("delta_R_p99", &F::accuracy, &Accuracy::p99, {"δ_R p99", "{:.4f}"}),
        real("delta_R_fine_max", &F::accuracy_fine, &Accuracy::max, {"fine max", "{:.4f}"}),
        real("delta_R_fine_mean", &F::accuracy_fine, &Accuracy::mean),
        real("delta_R_fine_p95", &F::accuracy_fine, &Accuracy::p95),
        real("delta_R_fine_p99", &F::accuracy_fine, &Accuracy::p99),
        real("delta_metric_R_max", &F::accuracy, &Accuracy::riemannian_max),
        real("coarser_max", &F::accuracy, &Accuracy::coarser_max),
        real("coarser_share", &F::accuracy, &Accuracy::coarser_share),
        real("coarser_fine_max", &F::accuracy_fine, &Accuracy::coarser_max),
        real("coarser_fine_share", &F::accuracy_fine, &Accuracy::coarser_share,
             {"fine coarser", "{:.2f} %", 100}),
        real("finer_max", &F::accuracy, &Accuracy::finer_max),
        real("finer_share", &F::accuracy, &Accuracy::finer_share),
        real("finer_fine_max", &F::accuracy_fine, &Accuracy::finer_max),
        real("finer_fine_share", &F::accuracy_fine, &Accuracy::finer_share,
             {"fine finer", "{:.2f} %", 100}),
        {"within_max", "", [](const F& f) { return f.accuracy.within(); }},
        {"within_fine_max",
         "",
         [](const F& f) { return f.accuracy_fine.within(); },
         {"within", "{:.3f}x"}},
        real("G_det", &F::steepness, &Steepness::det, {"G_det", "{:.3f}"}),
        real("G_dir", &F::steepness, &Steepness::dir, {"G_dir", "{:.3f}"}),
        {"gradation_max_left",
         "",
         [](const F& f) { return f.creation.gradation.largest_ratio_left; },
         {"G left", "{:.4f}"}},
        counted("gradation_operations", "",
                [](const Finished& f) { return f.creation.gradation.operations; }),
        // As text: JSON readers keep 53 bits of a number.
        {"checksum", "",
         [](const Finished& f) { return fmt::format("{:016x}", f.access_random.checksum); }},
        {"remark",
         "",
         [](const Finished& f) { return remark_on(f.creation, f.footprint) + found_by_probes(f); },
         {"remark", "{}"}},
        {"shortfall", "", [](const Finished& f) { return f.creation.shortfall; }},
    };
}

}  // namespace

std::span<const Measure> measures() {
    static const std::vector<Measure> all = [] {
        std::vector<Measure> rows = size_rows();
        for (const auto& more : {time_rows(), accuracy_rows()}) {
            rows.insert(rows.end(), more.begin(), more.end());
        }
        return rows;
    }();
    return all;
}

std::string remark_on(const Creation& creation, const Footprint& footprint) {
    std::string text;
    for (const std::string& part : {footprint.remark, creation.remark, creation.shortfall}) {
        text += (text.empty() || part.empty() ? "" : "; ") + part;
    }
    return text;
}

std::vector<Measure> sampled_measure(const std::string& key, const std::string& unit,
                                     std::function<Samples(const Finished&)> samples,
                                     const Column& column) {
    const auto at = [&](int number) {
        return [samples, number](const Finished& f) -> MeasuredValue {
            return quartile(samples(f), number);
        };
    };
    return {{key, unit, at(2), column},
            {key + "_q1", unit, at(1)},
            {key + "_q3", unit, at(3)},
            {key + "_samples", unit,
             [samples](const Finished& f) -> MeasuredValue { return samples(f); }}};
}

double Row::number(const std::string& key) const {
    const auto found = values.find(key);
    if (found == values.end()) return std::numeric_limits<double>::quiet_NaN();
    if (const auto* whole = std::get_if<std::int64_t>(&found->second)) {
        return static_cast<double>(*whole);
    }
    const auto* real = std::get_if<double>(&found->second);
    return real != nullptr ? *real : std::numeric_limits<double>::quiet_NaN();
}

std::string Row::text(const std::string& key) const {
    const auto found = values.find(key);
    const auto* text = found == values.end() ? nullptr : std::get_if<std::string>(&found->second);
    return text != nullptr ? *text : "";
}

}  // namespace controlspace
