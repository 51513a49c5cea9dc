// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "controlspace/metric/metric.h"

namespace controlspace {

/// A metric that is intersected with one metric after another: what repeated `intersection` gives,
/// up to rounding, in a tenth of the time where a step shortens the metric along one direction
/// only.
class RunningIntersection {
public:
    explicit RunningIntersection(const Metric& m);

    /// Intersects with `m`. False, and nothing changes, if the metric reached lies within `m`.
    bool shorten_to(const Metric& m);

    /// The metric reached; the first one to the bit while nothing has changed.
    Metric metric() const;

    /// Its square.
    const Metric& square() const { return square_; }

    /// Its longest length, or more: brought up to date now and then.
    double longest() const { return longest_; }

private:
    bool shorten_in_general(const Metric& m);
    void update(const Eigen::Matrix3d& factor);

    Eigen::Matrix3d factor_;  ///< H, such that the metric's square is H H^T
    Metric square_;
    double longest_;
    Metric metric_;  ///< unless is_factored_
    bool is_factored_ = false;
    unsigned changes_ = 0;
};

}  // namespace controlspace
