// SPDX-License-Identifier: Apache-2.0
#include "cones/tensor_tree.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "controlspace/sources/cone.h"
#include "geometry/extent_of.h"
#include "metric/running_intersection.h"

namespace controlspace {

namespace {

// What holds for all of some sources.
struct Bounds {
    Metric within;   // all metrics
    Metric inverse;  // within all inverses
    double length;   // smallest
    double growth;   // smallest ratio
};

// Of all that one of `parts` holds for; there is one at least.
Bounds bounds_of(std::span<const Bounds> parts) {
    RunningIntersection within(parts.front().within);
    RunningIntersection inverse(parts.front().inverse);
    double length = parts.front().length;
    double growth = parts.front().growth;
    for (const Bounds& part : parts.subspan(1)) {
        within.shorten_to(part.within);
        inverse.shorten_to(part.inverse);
        length = std::min(length, part.length);
        growth = std::min(growth, part.growth);
    }
    return {within.metric(), inverse.metric(), length, growth};
}

// Largest distance from `centre` as `measure` has it: |measure (Q - centre)|.
double radius_of(std::span<const ConeTreeItem> items, const Point& centre, const Metric& measure) {
    const Eigen::Matrix3d matrix = measure.matrix();
    double squared = 0;
    for (const ConeTreeItem& item : items) {
        squared = std::max(squared, (matrix * (item.position() - centre)).squaredNorm());
    }
    return std::sqrt(squared);
}

}  // namespace

Metric inverse(const Metric& m) {
    EigenFrame frame = eigen_frame(m);
    for (double& length : frame.lengths) length = 1 / length;
    return metric_from_frame(frame.lengths, frame.directions);
}

TensorTree build_tensor_tree(std::span<ConeTreeItem> items, std::span<const PointSource> sources,
                             std::span<const double> lengths, double g) {
    using Items = std::span<const ConeTreeItem>;
    const auto make_leaf = [&](Items of_leaf, TensorLeaf& leaf) {
        for (int lane = 0; lane < lane_count; ++lane) {
            const auto i = static_cast<std::size_t>(lane);
            const bool exists = i < of_leaf.size();
            const std::uint32_t source = of_leaf[exists ? i : 0].index;
            leaf.position.set(lane, sources[source].position);
            leaf.metric.set(lane, sources[source].metric);
            leaf.length[lane] = exists ? lengths[source] : std::numeric_limits<double>::infinity();
            leaf.growth[lane] = cone_growth(sources[source], g);
        }
    };
    const auto bounds_of_leaf = [&](Items of_leaf) {
        std::array<Bounds, lane_count> parts;
        for (std::size_t i = 0; i < of_leaf.size(); ++i) {
            const PointSource& source = sources[of_leaf[i].index];
            parts[i] = {source.metric, inverse(source.metric), lengths[of_leaf[i].index],
                        cone_growth(source, g)};
        }
        return bounds_of(std::span(parts).first(of_leaf.size()));
    };
    TensorTree tree;
    std::vector<Bounds> bounds_of_node(
        ConeTreeShape::with_leaves_of(items.size(), lane_count).nodes());
    const auto make_node = [&](std::span<const TensorTree::Child> children, TensorNode& node,
                               std::uint32_t number) {
        std::array<Bounds, lane_count> parts;
        std::size_t count = 0;
        for (std::size_t i = 0; i < children.size(); ++i) {
            const auto& [child, of_child] = children[i];
            if (of_child.empty()) continue;
            const auto lane = static_cast<Eigen::Index>(i);
            const Bounds bounds =
                tree.is_leaf(child) ? bounds_of_leaf(of_child) : bounds_of_node[child];
            const Point centre = extent_of(of_child, &ConeTreeItem::position).centre();
            node.centre.set(lane, centre);
            node.radius[lane] = radius_of(of_child, centre, bounds.inverse);
            node.inverse.set(lane, bounds.inverse);
            node.square.set(lane, square(bounds.within));
            node.length[lane] = bounds.length;
            node.growth[lane] = bounds.growth;
            parts[count++] = bounds;
        }
        bounds_of_node[number] = bounds_of(std::span(parts).first(count));
    };
    tree.build(items, lane_count, make_leaf, make_node);
    return tree;
}

}  // namespace controlspace
