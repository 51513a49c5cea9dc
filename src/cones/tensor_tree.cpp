#include "cones/tensor_tree.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "metric/running_intersection.h"

namespace controlspace {

namespace {

using Item = TensorTree::Item;
using Node = TensorTree::Node;
using Leaf = TensorTree::Leaf;

constexpr double infinity = std::numeric_limits<double>::infinity();

Metric inverse(const Metric& m) {
    EigenFrame frame = eigen_frame(m);
    for (double& length : frame.lengths) length = 1 / length;
    return metric_from_frame(frame.lengths, frame.directions);
}

// What holds for all of some sources.
struct Bounds {
    Metric within;   // all metrics
    Metric inverse;  // within all inverses
    double length;   // smallest
};

Bounds bounds_of(const Item& item) {
    return {item.source.metric, inverse(item.source.metric), item.length};
}

// Of all that one of `parts` holds for; there is one at least.
Bounds bounds_of(std::span<const Bounds> parts) {
    RunningIntersection within(parts.front().within);
    RunningIntersection inverse(parts.front().inverse);
    double length = parts.front().length;
    for (const Bounds& part : parts.subspan(1)) {
        within.shorten_to(part.within);
        inverse.shorten_to(part.inverse);
        length = std::min(length, part.length);
    }
    return {within.metric(), inverse.metric(), length};
}

struct Ball {
    Point centre;
    double radius;  // as `measure` has it

    Ball(std::span<const Item> items, const Metric& measure) {
        Point low = items.front().source.position;
        Point high = low;
        for (const Item& item : items) {
            low = low.cwiseMin(item.source.position);
            high = high.cwiseMax(item.source.position);
        }
        centre = 0.5 * (low + high);
        const Eigen::Matrix3d matrix = measure.matrix();
        double squared = 0;
        for (const Item& item : items) {
            squared = std::max(squared, (matrix * (item.source.position - centre)).squaredNorm());
        }
        radius = std::sqrt(squared);
    }
};

// Lanes without a source are as far as need be for them to have no part in anything.
Leaf make_leaf(std::span<const Item> items) {
    Leaf leaf;
    for (int lane = 0; lane < lane_count; ++lane) {
        const auto i = static_cast<std::size_t>(lane);
        const Item& item = i < items.size() ? items[i] : items.front();
        leaf.position.set(lane, item.source.position);
        leaf.metric.set(lane, item.source.metric);
        leaf.length[lane] = i < items.size() ? item.length : infinity;
    }
    return leaf;
}

void set_child(Node& node, int lane, const Bounds& bounds, const Ball& ball) {
    node.centre.set(lane, ball.centre);
    node.radius[lane] = ball.radius;
    node.inverse.set(lane, bounds.inverse);
    node.square.set(lane, square(bounds.within));
    node.length[lane] = bounds.length;
}

}  // namespace

TensorTree::TensorTree(std::vector<Item> items, double weight)
    : shape_(ConeTreeShape::with_leaves_of(items.size(), lane_count)) {
    if (items.empty()) return;
    put_in_order(items, weight);
    indices_ = std::vector<std::uint32_t>(items.size());
    std::transform(items.begin(), items.end(), indices_.begin(),
                   [](const Item& item) { return item.index; });
    const auto items_of = [&](std::size_t begin, std::size_t end) {
        return std::span<const Item>(items).subspan(begin, end - begin);
    };

    leaves_ = std::vector<Leaf>(shape_.leaves);
    std::vector<Bounds> below(shape_.leaves);
    tbb::parallel_for(std::size_t{0}, leaves_.size(), [&](std::size_t l) {
        const std::size_t begin = l * lane_count;
        const auto of_leaf = items_of(begin, std::min(begin + lane_count, items.size()));
        leaves_[l] = make_leaf(of_leaf);
        std::array<Bounds, lane_count> bounds;
        for (std::size_t i = 0; i < of_leaf.size(); ++i) bounds[i] = bounds_of(of_leaf[i]);
        below[l] = bounds_of({bounds.data(), of_leaf.size()});
    });

    const std::vector<int> levels = levels_of_eight_children(shape_.depth);
    std::vector<std::size_t> first(levels.size() + 1, 0);
    for (std::size_t l = 0; l < levels.size(); ++l) {
        first[l + 1] = first[l] + (std::size_t{1} << levels[l]);
    }
    nodes_ = std::vector<Node>(first.back());
    for (std::size_t l = levels.size(); l-- > 0;) {
        const bool has_leaves = l + 1 == levels.size();
        const int level_below = has_leaves ? shape_.depth : levels[l + 1];
        const std::size_t children = std::size_t{1} << (level_below - levels[l]);
        std::vector<Bounds> here(std::size_t{1} << levels[l]);
        tbb::parallel_for(std::size_t{0}, here.size(), [&](std::size_t n) {
            Node& node = nodes_[first[l] + n];
            node.first_child = static_cast<std::uint32_t>(first[l + 1] + n * children);
            node.length.setConstant(infinity);
            std::array<Bounds, lane_count> bounds;
            std::size_t count = 0;
            for (std::size_t c = 0; c < children; ++c) {
                const auto child = static_cast<std::uint32_t>(n * children + c);
                const std::uint32_t number = (std::uint32_t{1} << level_below) + child;
                const auto of_child = items_of(shape_.begin(number), shape_.end(number));
                if (of_child.empty()) continue;
                const Bounds& b = below[has_leaves ? shape_.leaf_in(child) : child];
                set_child(node, static_cast<int>(c), b, Ball(of_child, b.inverse));
                bounds[count++] = b;
            }
            here[n] = bounds_of({bounds.data(), count});
        });
        below = std::move(here);
    }
}

void TensorTree::put_in_order(std::vector<Item>& items, double weight) const {
    std::vector<ConeTreeItem> order(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) {
        const Point& q = items[i].source.position;
        order[i] = {{q.x(), q.y(), q.z(), weight * items[i].length}, static_cast<std::uint32_t>(i)};
    }
    sort_for_tree(shape_, order);
    std::vector<Item> ordered(items.size());
    tbb::parallel_for(std::size_t{0}, items.size(),
                      [&](std::size_t i) { ordered[i] = items[order[i].index]; });
    items = std::move(ordered);
}

}  // namespace controlspace
