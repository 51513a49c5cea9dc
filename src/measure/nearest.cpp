#include "measure/nearest.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace controlspace {
namespace {

/// A balanced implicit kd-tree: the middle of a range of `order_` is its root, points before it are
/// on the low side.
class PointTree {
public:
    explicit PointTree(std::span<const Point> points)
        : points_(points), order_(points.size()), axes_(points.size()) {
        std::iota(order_.begin(), order_.end(), NodeIndex{0});
        build(0, order_.size());
    }

    /// Points that follow each other lie near each other.
    std::span<const NodeIndex> order() const { return order_; }

    using Found = std::vector<std::pair<double, NodeIndex>>;  ///< squared distance, point

    /// The points nearest to `x` but not there, ascending.
    void find(const Point& x, std::size_t most, Found& found) const {
        found.clear();
        search(0, order_.size(), x, most, found);
        std::sort_heap(found.begin(), found.end());
    }

private:
    void build(std::size_t first, std::size_t last) {
        if (last - first < 2) return;
        Point low = points_[order_[first]], high = low;
        for (std::size_t i = first; i < last; ++i) {
            low = low.cwiseMin(points_[order_[i]]);
            high = high.cwiseMax(points_[order_[i]]);
        }
        Axis axis = 0;
        (high - low).maxCoeff(&axis);
        const auto begin = order_.begin();
        const std::size_t middle = first + (last - first) / 2;
        std::nth_element(
            begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(middle),
            begin + static_cast<std::ptrdiff_t>(last),
            [&](NodeIndex i, NodeIndex j) { return points_[i][axis] < points_[j][axis]; });
        axes_[middle] = static_cast<std::uint8_t>(axis);
        build(first, middle);
        build(middle + 1, last);
    }

    void search(std::size_t first, std::size_t last, const Point& x, std::size_t most,
                Found& found) const {
        if (first == last) return;
        const std::size_t middle = first + (last - first) / 2;
        const Point& p = points_[order_[middle]];
        const double squared = (p - x).squaredNorm();
        const bool full = found.size() == most;
        if (squared > 0 && (!full || squared < found.front().first)) {
            if (full) {
                std::pop_heap(found.begin(), found.end());
                found.pop_back();
            }
            found.emplace_back(squared, order_[middle]);
            std::push_heap(found.begin(), found.end());
        }
        const double beyond = x[axes_[middle]] - p[axes_[middle]];
        const auto search_side = [&](bool low) {
            low ? search(first, middle, x, most, found) : search(middle + 1, last, x, most, found);
        };
        search_side(beyond < 0);
        if (found.size() < most || beyond * beyond < found.front().first) search_side(beyond >= 0);
    }

    std::span<const Point> points_;
    std::vector<NodeIndex> order_;
    std::vector<std::uint8_t> axes_;  ///< of cuts, by place in order_
};

}  // namespace

NodeGraph nearest_neighbours(std::span<const Point> points, std::size_t most) {
    const PointTree tree(points);
    std::vector<NodeIndex> nearest(points.size() * most);
    NodeGraph graph;
    graph.positions.assign(points.begin(), points.end());
    graph.first.assign(points.size() + 1, 0);
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, points.size(), 1024), [&](const auto& some) {
            PointTree::Found found;
            for (std::size_t k = some.begin(); k < some.end(); ++k) {
                const NodeIndex i = tree.order()[k];
                tree.find(points[i], most, found);
                graph.first[i + 1] = found.size();
                std::ranges::transform(found,
                                       nearest.begin() + static_cast<std::ptrdiff_t>(i * most),
                                       [](const auto& place) { return place.second; });
            }
        });
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto begin = nearest.begin() + static_cast<std::ptrdiff_t>(i * most);
        graph.neighbours.insert(graph.neighbours.end(), begin,
                                begin + static_cast<std::ptrdiff_t>(graph.first[i + 1]));
        graph.first[i + 1] += graph.first[i];
    }
    return graph;
}

}  // namespace controlspace
