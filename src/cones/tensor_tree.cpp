#include "cones/tensor_tree.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <limits>

#include "metric/running_intersection.h"

namespace controlspace {

namespace {

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

Bounds bounds_of(const TensorTree::Item& item) {
    return {item.source.metric, inverse(item.source.metric), item.length};
}

// Of all that each of `parts` holds for; there is one at least.
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

}  // namespace

TensorTree::TensorTree(std::span<const Item> items, double weight) {
    const auto shape = ConeTreeShape::with_leaves_of(items.size(), lane_count);
    std::vector<ConeTreeItem> order(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) {
        const Point& q = items[i].source.position;
        order[i] = {{q.x(), q.y(), q.z(), weight * items[i].length}, static_cast<std::uint32_t>(i)};
    }
    sort_for_tree(shape, order);
    indices_ = std::vector<std::uint32_t>(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) indices_[i] = items[order[i].index].index;
    if (items.empty()) return;
    const auto item = [&](std::size_t place) -> const Item& { return items[order[place].index]; };

    leaves_ = std::vector<Leaf>(shape.first_leaf());
    std::vector<Bounds> below(leaves_.size());
    tbb::parallel_for(std::size_t{0}, leaves_.size(), [&](std::size_t l) {
        const auto number = shape.first_leaf() + static_cast<std::uint32_t>(l);
        const std::size_t begin = shape.begin(number);
        const std::size_t end = shape.end(number);
        Leaf& leaf = leaves_[l];
        leaf.first = static_cast<std::uint32_t>(begin);
        std::array<Bounds, lane_count> bounds;
        for (std::size_t lane = 0; lane < lane_count; ++lane) {
            const bool exists = begin + lane < end;
            const Item& i = item(exists ? begin + lane : begin);
            const auto to = static_cast<Eigen::Index>(lane);
            leaf.position.set(to, i.source.position);
            leaf.metric.set(to, i.source.metric);
            leaf.length[to] = exists ? i.length : infinity;
            if (exists) bounds[lane] = bounds_of(i);
        }
        below[l] = bounds_of({bounds.data(), end - begin});
    });

    const std::vector<int> levels = levels_of_eight_children(shape.depth);
    std::vector<std::size_t> first(levels.size() + 1, 0);
    for (std::size_t l = 0; l < levels.size(); ++l) {
        first[l + 1] = first[l] + (std::size_t{1} << levels[l]);
    }
    nodes_ = std::vector<Node>(first.back());
    for (std::size_t l = levels.size(); l-- > 0;) {
        const int level_below = l + 1 < levels.size() ? levels[l + 1] : shape.depth;
        const std::size_t children = std::size_t{1} << (level_below - levels[l]);
        std::vector<Bounds> here(std::size_t{1} << levels[l]);
        tbb::parallel_for(std::size_t{0}, here.size(), [&](std::size_t n) {
            Node& node = nodes_[first[l] + n];
            node.first_child = static_cast<std::uint32_t>(first[l + 1] + n * children);
            here[n] = bounds_of(std::span(below).subspan(n * children, children));
            for (std::size_t c = 0; c < lane_count; ++c) {
                const bool exists = c < children;
                const std::size_t child = n * children + (exists ? c : 0);
                const auto number =
                    static_cast<std::uint32_t>((std::size_t{1} << level_below) + child);
                const std::size_t begin = shape.begin(number);
                const std::size_t end = shape.end(number);
                Point low = item(begin).source.position;
                Point high = low;
                for (std::size_t i = begin; i < end; ++i) {
                    low = low.cwiseMin(item(i).source.position);
                    high = high.cwiseMax(item(i).source.position);
                }
                const Point centre = 0.5 * (low + high);
                const Eigen::Matrix3d measure = below[child].inverse.matrix();
                double squared_radius = 0;
                for (std::size_t i = begin; i < end; ++i) {
                    squared_radius =
                        std::max(squared_radius,
                                 (measure * (item(i).source.position - centre)).squaredNorm());
                }
                const auto to = static_cast<Eigen::Index>(c);
                node.centre.set(to, centre);
                node.radius[to] = std::sqrt(squared_radius);
                node.inverse.set(to, below[child].inverse);
                node.square.set(to, below[child].within);
                node.length[to] = exists ? below[child].length : infinity;
            }
            node.square = square(node.square);
        });
        below = std::move(here);
    }
}

}  // namespace controlspace
