#pragma once

#include "study/row.h"

namespace controlspace {

/// A row with a different number in every measure.
inline Row sample_row(Case setting) {
    Measures m;
    m.sources_inserted = 101;
    m.footprint = {.elements = 102,
                   .leaves = 103,
                   .control_nodes = 104,
                   .depth = 22,
                   .bytes_payload = 1'000'000,
                   .bytes_topology = 200'000,
                   .bytes_auxiliary = 30'000,
                   .bytes_published = 17'070'000,
                   .remark = "a remark, with \"quotes\""};
    m.insert_s = 1.5;
    m.gradation_s = 0.25;
    m.gradation = {.operations = 105, .largest_ratio_left = 1.2499};
    m.access_random = {.samples_ns = {52, 50, 51}, .checksum = 0xff00000000000001};
    m.access_grid = {.samples_ns = {12, 10, 11}, .checksum = 2};
    m.accuracy = {.max = 1.78,
                  .mean = 0.08,
                  .p95 = 0.3,
                  .p99 = 0.4,
                  .riemannian_max = 9.5,
                  .coarser_max = 1.3,
                  .coarser_share = 0.06};
    m.accuracy_fine = {.max = 2.78,
                       .mean = 0.09,
                       .p95 = 0.31,
                       .p99 = 0.41,
                       .coarser_max = 1.4,
                       .coarser_share = 0.07};
    m.source_accuracy = 0.19;
    return {std::move(setting), 36186, m, ""};
}

/// K_L s_L of the paper's tables at rho = tau = 1.
inline Case published_case() {
    return {.structure = "K_L",
            .split = SplitRule::middle,
            .max_depth = 42,
            .law = GradationLaw::mean_length,
            .schedule = GradationSchedule::passes,
            .reference = ReferenceKind::published_sphere};
}

}  // namespace controlspace
