// SPDX-License-Identifier: Apache-2.0
#include "study/rank_correlation.h"

#include <Eigen/Core>
#include <algorithm>

namespace controlspace {

std::vector<double> average_ranks(std::span<const double> values) {
    std::vector<double> ranks;
    for (const double x : values) {
        const auto below = std::ranges::count_if(values, [&](double y) { return y < x; });
        const auto equal = std::ranges::count(values, x);
        ranks.push_back(static_cast<double>(below) + 0.5 * static_cast<double>(equal + 1));
    }
    return ranks;
}

std::optional<double> spearman(std::span<const double> a, std::span<const double> b) {
    if (a.size() < 3) return std::nullopt;
    const auto centred = [](const std::vector<double>& ranks) -> Eigen::VectorXd {
        const Eigen::Map<const Eigen::ArrayXd> all(ranks.data(),
                                                   static_cast<Eigen::Index>(ranks.size()));
        return all - all.mean();
    };
    const Eigen::VectorXd x = centred(average_ranks(a)), y = centred(average_ranks(b));
    if (x.isZero() || y.isZero()) return std::nullopt;
    return x.dot(y) / (x.norm() * y.norm());
}

}  // namespace controlspace
