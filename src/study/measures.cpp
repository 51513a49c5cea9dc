// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <limits>

#include "controlspace/metric/nonconformity.h"
#include "controlspace/study/measure.h"

namespace controlspace {
namespace {

using Samples = std::vector<double>;

using F = Finished;

std::vector<Measure> size_rows() {
    return {
        row_of("sources_inserted", &F::creation, &Creation::sources_inserted),
        row_of("tree_nodes", &F::footprint, &Footprint::tree_nodes),
        row_of("cells", &F::footprint, &Footprint::cells, {"cells", "{}"}),
        row_of("control_nodes", &F::footprint, &Footprint::control_nodes),
        row_of("depth", &F::footprint, &Footprint::depth),
        row_of("bytes_total", &F::footprint, &Footprint::bytes_total, {"MB", "{:.2f}", 1e-6},
               "byte"),
        row_of("bytes_payload", &F::footprint, &Footprint::bytes_payload, {}, "byte"),
        row_of("bytes_topology", &F::footprint, &Footprint::bytes_topology, {}, "byte"),
        row_of("bytes_auxiliary", &F::footprint, &Footprint::bytes_auxiliary, {}, "byte"),
    };
}

std::vector<Measure> time_rows() {
    std::vector<Measure> rows;
    const auto add = [&](const std::string& key, const char* unit, auto samples,
                         const Column& column) {
        const auto more = sampled_measure(key, unit, samples, column);
        rows.insert(rows.end(), more.begin(), more.end());
    };
    const auto add_access = [&](const char* order, AccessTime Finished::*time,
                                const Column& column = {}) {
        add(
            fmt::format("t_access_ns_{}", order), "ns",
            [time](const Finished& f) { return (f.*time).samples_ns; }, column);
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
    rows.push_back({.key = "t_creation_known_s",
                    .unit = "s",
                    .value = [](const Finished& f) -> MeasuredValue {
                        if (f.creation.known_s.empty()) return {};
                        return quartile(f.creation.known_s, 2);
                    },
                    .may_be_missing = true});
    add_access("random", &F::access_random, {"random ns", "{:.1f}"});
    add_access("grid", &F::access_grid);
    const auto add_newer = [&](const char* order, AccessTime Finished::*time,
                               const Column& column = {}) {
        const std::size_t earlier = rows.size();
        add_access(order, time, column);
        for (std::size_t i = earlier; i < rows.size(); ++i) rows[i].may_be_missing = true;
    };
    add_newer("near", &F::access_near, {"near ns", "{:.1f}"});
    add_access("single", &F::access_single, {"single ns", "{:.1f}"});
    add_newer("walk", &F::access_walk);
    add_newer("metric_random", &F::access_metric_random);
    add_newer("metric_single", &F::access_metric_single);
    const auto answers = [](const Finished& f) {
        return f.answers() == Answers::lengths ? "lengths" : "metrics";
    };
    rows.push_back({.key = "answers", .unit = "", .value = answers, .may_be_missing = true});
    rows.push_back(row_of("access_batch", &F::access_batch, std::identity()));
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

/// "stopped at 60 s, 1234 leaves, δ 0.31 reached"; empty where no limit ended the making.
std::string stopped_text(const Finished& f) {
    if (f.creation.stopped.empty()) return "";
    return fmt::format("stopped {}, {} {}, δ {:.4g} reached", f.creation.stopped, f.footprint.cells,
                       f.footprint.tree_nodes > 0 ? "leaves" : "cells",
                       std::max(f.accuracy.max, f.accuracy_fine.max));
}

std::vector<Measure> accuracy_rows() {
    return {
        {"delta_S_max", "", [](const Finished& f) { return f.source_accuracy; }},
        row_of("delta_R_max", &F::accuracy, &Accuracy::max, {"δ_R max", "{:.4f}"}),
        row_of("delta_R_mean", &F::accuracy, &Accuracy::mean, {"δ_R mean", "{:.4f}"}),
        row_of("delta_R_p95", &F::accuracy, &Accuracy::p95),
        row_of("delta_R_p99", &F::accuracy, &Accuracy::p99, {"δ_R p99", "{:.4f}"}),
        row_of("delta_R_fine_max", &F::accuracy_fine, &Accuracy::max, {"fine max", "{:.4f}"}),
        row_of("delta_R_fine_mean", &F::accuracy_fine, &Accuracy::mean),
        row_of("delta_R_fine_p95", &F::accuracy_fine, &Accuracy::p95),
        row_of("delta_R_fine_p99", &F::accuracy_fine, &Accuracy::p99),
        row_of("delta_metric_R_max", &F::accuracy, &Accuracy::riemannian_max),
        row_of("coarser_max", &F::accuracy, &Accuracy::coarser_max),
        row_of("coarser_share", &F::accuracy, &Accuracy::coarser_share),
        row_of("coarser_fine_max", &F::accuracy_fine, &Accuracy::coarser_max),
        row_of("coarser_fine_share", &F::accuracy_fine, &Accuracy::coarser_share,
               {"fine coarser", "{:.2f} %", 100}),
        row_of("finer_max", &F::accuracy, &Accuracy::finer_max),
        row_of("finer_share", &F::accuracy, &Accuracy::finer_share),
        row_of("finer_fine_max", &F::accuracy_fine, &Accuracy::finer_max),
        row_of("finer_fine_share", &F::accuracy_fine, &Accuracy::finer_share,
               {"fine finer", "{:.2f} %", 100}),
        row_of("within_max", &F::accuracy, &Accuracy::within),
        row_of("within_fine_max", &F::accuracy_fine, &Accuracy::within, {"within", "{:.3f}x"}),
        row_of("G_det", &F::steepness, &Steepness::det, {"G_det", "{:.3f}"}),
        row_of("G_dir", &F::steepness, &Steepness::dir, {"G_dir", "{:.3f}"}),
        row_of("gradation_max_left", &F::creation,
               [](const Creation& c) { return c.gradation.largest_ratio_left; },
               {"G left", "{:.4f}"}),
        row_of("gradation_operations", &F::creation,
               [](const Creation& c) { return c.gradation.operations; }),
        // As text: JSON readers keep 53 bits of a number.
        {"checksum", "",
         [](const Finished& f) {
             const bool has_lengths = f.answers() == Answers::lengths;
             const AccessTime& metrics = has_lengths ? f.access_metric_random : f.access_random;
             return fmt::format("{:016x}", metrics.checksum);
         }},
        {"remark",
         "",
         [](const Finished& f) {
             std::string remark = stopped_text(f);
             const std::string more = remark_on(f.creation, f.footprint) + found_by_probes(f);
             return remark + (remark.empty() || more.empty() ? "" : "; ") + more;
         },
         {"remark", "{}"}},
        {"shortfall", "", [](const Finished& f) { return f.creation.shortfall; }},
        {.key = "stopped", .unit = "", .value = stopped_text, .may_be_missing = true},
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
            const Samples found = samples(f);
            if (found.empty()) return {};
            return quartile(found, number);
        };
    };
    return {{key, unit, at(2), column},
            {key + "_q1", unit, at(1)},
            {key + "_q3", unit, at(3)},
            {key + "_samples", unit, [samples](const Finished& f) -> MeasuredValue {
                 Samples found = samples(f);
                 if (found.empty()) return {};
                 return found;
             }}};
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
