// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "controlspace/metric/metric.h"

namespace controlspace {

/// Simultaneous reduction of two metrics: b^-1 a = U diag(s) V^T, s descending. Column i of `av`
/// is s_i times column i of `bu`.
struct Reduction {
    std::array<double, 3> s;
    Eigen::Matrix3d av, bu;

    /// Whether `a` is the shorter one along the i-th direction.
    bool is_of_first(int i) const { return s[static_cast<std::size_t>(i)] <= 1; }
    /// H with H H^T the square of the intersection: each column from the shorter one.
    Eigen::Matrix3d half() const {
        Eigen::Matrix3d h = av;
        for (int i = 0; i < 3; ++i) {
            if (!is_of_first(i)) h.col(i) = bu.col(i);
        }
        return h;
    }
};

/// Digits are lost only where the six numbers of the metrics lack them.
Reduction reduce(const Metric& a, const Metric& b);

}  // namespace controlspace
