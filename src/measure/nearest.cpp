// SPDX-License-Identifier: Apache-2.0
#include "measure/nearest.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <unsupported/Eigen/BVH>
#include <utility>
#include <vector>

namespace controlspace {
namespace {

/// A search for Eigen::BVMinimize: the `most` points nearest to one of `points`, but not there.
struct Nearest {
    std::span<const Point> points;
    Point x;
    std::size_t most;
    std::vector<std::pair<double, NodeIndex>> found = {};  ///< squared distance, point: a heap

    // NOLINTBEGIN(readability-identifier-naming): Eigen's names
    using Scalar = double;
    double minimumOnVolume(const Eigen::AlignedBox3d& box) const {
        return box.squaredExteriorDistance(x);
    }
    /// The squared distance below which further points count.
    double minimumOnObject(NodeIndex i) {
        const double squared = (points[i] - x).squaredNorm();
        if (squared > 0) {
            found.emplace_back(squared, i);
            std::push_heap(found.begin(), found.end());
        }
        if (found.size() > most) {
            std::pop_heap(found.begin(), found.end());
            found.pop_back();
        }
        return found.size() < most ? std::numeric_limits<double>::infinity() : found.front().first;
    }
    // NOLINTEND(readability-identifier-naming)
};

}  // namespace

NodeGraph nearest_neighbours(std::span<const Point> points, std::size_t most) {
    std::vector<NodeIndex> numbers(points.size());
    std::iota(numbers.begin(), numbers.end(), NodeIndex{0});
    const std::vector<Eigen::AlignedBox3d> boxes(points.begin(), points.end());
    const Eigen::KdBVH<double, 3, NodeIndex> tree(numbers.begin(), numbers.end(), boxes.begin(),
                                                  boxes.end());
    std::vector<std::vector<NodeIndex>> nearest(points.size());
    tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
        Nearest search{points, points[i], most};
        Eigen::BVMinimize(tree, search);
        std::sort_heap(search.found.begin(), search.found.end());
        for (const auto& [squared, j] : search.found) nearest[i].push_back(j);
    });
    NodeGraph graph;
    graph.positions.assign(points.begin(), points.end());
    graph.first.push_back(0);
    for (const auto& found : nearest) {
        graph.neighbours.insert(graph.neighbours.end(), found.begin(), found.end());
        graph.first.push_back(graph.neighbours.size());
    }
    return graph;
}

}  // namespace controlspace
