// SPDX-License-Identifier: Apache-2.0
// Bounds of the field of tensors, and the sources within them.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include "mpi/tensor_needs.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "cones/exceeded_cones.h"
#include "controlspace/sources/cone.h"

namespace controlspace {
namespace {

constexpr double tolerance = 1e-2;

// The longest half diagonal of a box, as seen from H.
double half_diagonal(const Box& box, const Eigen::Matrix3d& h) {
    const Eigen::Matrix3d inverse = h.inverse();
    const Vector half = 0.5 * box.edges();
    double most = 0;
    for (const double x : {half.x(), -half.x()}) {
        for (const double y : {half.y(), -half.y()}) {
            most = std::max(most, (inverse * Vector(x, y, half.z())).norm());
        }
    }
    return most;
}

}  // namespace

TensorNeeds::TensorNeeds(Ranks& ranks, const Octants& octants, const SpaceOptions& space,
                         double steepest, std::span<const Record> own,
                         const std::vector<std::vector<Box>>& parts)
    : octants_(octants),
      ratio_(space.ratio),
      slope_(steepest - 1),
      largest_(largest_metric(space)),
      own_(own.size()),
      first_test_(octants.tree().leaves()),
      count_(octants.tree().leaves()) {
    const std::vector<PointSource> sources = own_and_some(ranks, own);
    std::vector<Test> tests;
    std::vector<int> counts;
    ranks.together([&] {
        cones_ = std::make_unique<OrderFreeCones>(sources, ratio_, largest_, tolerance);
        OrderFreeCones::Search search;
        for (const std::vector<Box>& boxes : parts) {
            counts.push_back(static_cast<int>(boxes.size()));
            for (const Box& box : boxes) tests.push_back(test_in(box, sources, search));
        }
    });
    tests_ = ranks.gather(tests).values;
    const std::vector<int> all_counts = ranks.gather(counts).values;
    std::size_t first = 0;
    for (std::size_t i = 0; i < all_counts.size(); ++i) {
        const LeafIndex octant = octants.order()[i];
        first_test_[octant] = first;
        count_[octant] = all_counts[i];
        first += static_cast<std::size_t>(all_counts[i]);
    }
}

// Own ones, and a few from each octant of the others.
std::vector<PointSource> TensorNeeds::own_and_some(Ranks& ranks,
                                                   std::span<const Record> own) const {
    constexpr std::size_t most = 8;
    std::vector<std::vector<std::uint32_t>> of_octants(octants_.tree().leaves());
    for (std::uint32_t k = 0; k < own.size(); ++k) {
        of_octants[octants_.tree().find(own[k].position)].push_back(k);
    }
    std::vector<Record> some;
    for (const auto& numbers : of_octants) {
        const std::size_t chosen = std::min(most, numbers.size());
        for (std::size_t i = 0; i < chosen; ++i) {
            some.push_back(own[numbers[i * numbers.size() / chosen]]);
        }
    }
    const auto all = ranks.gather(some);
    std::vector<PointSource> sources = sources_of(own);
    std::size_t next = 0;
    for (int r = 0; r < ranks.size(); ++r) {
        for (int i = 0; i < all.counts[static_cast<std::size_t>(r)]; ++i, ++next) {
            if (r != ranks.rank()) sources.push_back(all.values[next].source());
        }
    }
    return sources;
}

TensorNeeds::Test TensorNeeds::test_in(const Box& box, std::span<const PointSource> sources,
                                       OrderFreeCones::Search& search) const {
    const Point c = box.centre();
    Eigen::Matrix3d least = Eigen::Matrix3d::Identity();
    double least_volume = std::numeric_limits<double>::infinity();
    // The field in the box is at most `bound`, times 1 + growth. A cone that is k times as long as
    // that at the centre is so everywhere if k is 1 + its own growth.
    const auto take = [&](const Eigen::Matrix3d& bound, double growth) {
        Eigen::Matrix3d h = (1 + growth) * bound;
        h *= 1 + slope_ * half_diagonal(box, h);
        const double volume = std::abs(h.determinant());
        if (!(volume < least_volume)) return;
        least_volume = volume;
        least = h;
    };
    take(largest_.matrix(), 0);
    const OrderFreeIntersection answer = cones_->intersect(c, nullptr, search);
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (const auto& [index, tensor] : answer.multipliers()) {
        sum += tensor.matrix();
        if (index == OrderFreeCones::index_of_largest) continue;
        const PointSource& source = sources[index];
        const Eigen::Matrix3d cone = cone_factor(source, ratio_, c) * source.metric.matrix();
        take(cone, slope_ * half_diagonal(box, cone));
    }
    // sum tr(L_k Y) <= most: Y <= most sum^-1, as seen from H.
    const Eigen::LLT<Eigen::Matrix3d> factored(sum);
    if (factored.info() == Eigen::Success) {
        const double most = 3 + answer.gap + std::log(sum.determinant());
        const Eigen::Matrix3d bound =
            std::sqrt(most) * factored.matrixU().solve(Eigen::Matrix3d::Identity());
        take(answer.factor * bound, slope_ * half_diagonal(box, answer.factor));
    }
    // Answers are nearly the field: by up to 2 sqrt(gap) longer.
    constexpr double nearly = 1.15;
    return {c, nearly * least};
}

std::size_t TensorNeeds::kept() const {
    return static_cast<std::size_t>(std::ranges::count_if(
        cones_->tree().indices(), [&](std::uint32_t index) { return index < own_; }));
}

std::vector<std::uint8_t> TensorNeeds::matter_in(std::span<const LeafIndex> octants) const {
    AllExceeded found(cones_->tree());
    for (const LeafIndex octant : octants) {
        for (int i = 0; i < count_[octant]; ++i) {
            const Test& test = tests_[first_test_[octant] + static_cast<std::size_t>(i)];
            found.add(Exceeding(test.place, test.factor));
        }
    }
    std::vector<std::uint8_t> matter(own_, 0);
    found.for_each([&](std::uint32_t index) {
        if (index < own_) matter[index] = 1;
    });
    return matter;
}

}  // namespace controlspace
