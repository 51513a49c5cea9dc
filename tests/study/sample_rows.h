// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/paper_reference.h"
#include "controlspace/study/measure.h"
#include "controlspace/study/parameter.h"
#include "controlspace/study/study.h"

namespace controlspace {

/// The rows of the program, and the six trees.
inline StudyRows tree_rows() { return {tree_catalogue(), program_parameters()}; }

/// A structure with a different number in every measure.
inline Finished sample_finished(const Case& setting) {
    static const Study study;
    static const Workload workload;
    static const ReferenceProbes probes;
    static const auto space = tree_catalogue()
                                  .front()
                                  .make({.domain = {Point::Constant(-1), Point::Constant(1)}})
                                  ->build();
    Finished f{0, study, setting, workload, probes, *space};
    f.creation = {.sources_inserted = 101,
                  .insert_s = {1.5, 1.4, 1.9},
                  .gradation_s = {0.25, 0.3, 0.2},
                  .gradation = {.operations = 105, .largest_ratio_left = 1.2499},
                  .remark = "a remark, with \"quotes\"",
                  .shortfall = ""};
    f.footprint = {.tree_nodes = 102,
                   .cells = 103,
                   .control_nodes = 104,
                   .depth = 21,
                   .bytes_payload = 1'000'000,
                   .bytes_topology = 200'000,
                   .bytes_auxiliary = 30'000,
                   .remark = ""};
    f.access_random = {.samples_ns = {52, 50, 51}, .checksum = 1};
    f.access_grid = {.samples_ns = {12, 10, 11}, .checksum = 2};
    f.access_single = {.samples_ns = {72, 70, 71}, .checksum = 1};
    f.access_near = {.samples_ns = {62, 60, 61}, .checksum = 3};
    f.access_walk = {.samples_ns = {32, 30, 31}, .checksum = 4};
    f.access_metric_random = {.samples_ns = {82, 80, 81}, .checksum = 0xff00000000000001};
    f.access_metric_single = {.samples_ns = {92, 90, 91}, .checksum = 0xff00000000000001};
    f.access_batch = 3;
    f.accuracy = {.max = 1.78,
                  .mean = 0.08,
                  .p95 = 0.3,
                  .p99 = 0.4,
                  .riemannian_max = 9.5,
                  .coarser_max = 1.3,
                  .coarser_share = 0.06,
                  .finer_max = 1.2,
                  .finer_share = 0.08};
    f.accuracy_fine = {.max = 2.78,
                       .mean = 0.09,
                       .p95 = 0.31,
                       .p99 = 0.41,
                       .coarser_max = 1.4,
                       .coarser_share = 0.07,
                       .finer_max = 1.25,
                       .finer_share = 0.09};
    f.source_accuracy = 0.19;
    f.steepness = {1.31, 1.62};
    return f;
}

inline Row sample_row(Case setting) {
    Row row;
    row.setting = std::move(setting);
    row.sources = 36186;
    const Finished finished = sample_finished(row.setting);
    for (const Measure& measure : measures()) row.values[measure.key] = measure.value(finished);
    return row;
}

/// K_L s_L of the paper's tables at rho = tau = 1.
inline Case published_case() {
    return {.structure = "K_L",
            .split = SplitRule::middle,
            .max_depth = 42,
            .law = GradationLaw::mean_length,
            .schedule = GradationSchedule::passes,
            .reference = &published_sphere()};
}

inline Row failed_row() {
    Row row;
    row.setting = published_case();
    row.setting.sources.kind = SourcesKind::file;
    row.sources = 5;
    row.error = "reason, \"as\" given";
    return row;
}

}  // namespace controlspace
