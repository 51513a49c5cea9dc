// SPDX-License-Identifier: Apache-2.0
#include "cones/quadric_tree.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "cones/tensor_tree.h"
#include "controlspace/sources/cone.h"

namespace controlspace {

namespace {

bool are_linear(const QuadricNode& node) {
    return std::all_of(node.terms.begin() + 3, node.terms.end(),
                       [](const auto& term) { return term == QuadricNode::Rows{}; });
}

// Of leaves: begin .. end - 1.
struct Range {
    std::size_t begin, end;

    std::size_t size() const { return end - begin; }
};

template <class Item>
std::span<Item> items_of(Range leaves, std::span<Item> items) {
    constexpr std::size_t size = QuadricTree::leaf_size;
    const std::size_t begin = size * leaves.begin;
    return items.subspan(begin, std::min(size * leaves.end, items.size()) - begin);
}

// Puts the items of some leaves in order, such that `parts` of nearly as many leaves follow one
// another, and calls visit(leaves) for each.
template <class Visit>
void cut(std::span<ConeTreeItem> items, Range leaves, std::size_t parts, const Visit& visit) {
    if (parts == 1) return visit(leaves);
    const std::size_t middle = leaves.begin + leaves.size() * (parts / 2) / parts;
    cut_longest_extent(items_of(leaves, items), QuadricTree::leaf_size * (middle - leaves.begin));
    cut(items, {leaves.begin, middle}, parts / 2, visit);
    cut(items, {middle, leaves.end}, parts - parts / 2, visit);
}

QuadricLeaf quadric_leaf(std::span<const std::uint32_t> indices,
                         std::span<const PointSource> sources,
                         std::span<const Metric> inverse_squares, double uncertainty, double g) {
    // As in `bounds_of`.
    constexpr double rounding = 128 * std::numeric_limits<double>::epsilon();
    const double most = 1 + 6 * uncertainty;
    const double least = std::max(1 - 6 * uncertainty, 0.0);
    QuadricLeaf leaf;
    for (std::size_t i = 0; i < indices.size(); ++i) {
        const std::uint32_t source = indices[i];
        const Metric a = most * inverse_squares[source];
        leaf.position.set(static_cast<Eigen::Index>(i), sources[source].position);
        leaf.terms[0][i] = a.xx;
        leaf.terms[1][i] = a.yy;
        leaf.terms[2][i] = a.zz;
        leaf.terms[3][i] = a.xy;
        leaf.terms[4][i] = a.xz;
        leaf.terms[5][i] = a.yz;
        leaf.doubt[i] = rounding * (a.xx + a.yy + a.zz);
        const double slope = cone_growth(sources[source], g) - 1;
        leaf.squared_slope[i] = least / most * slope * slope;
    }
    return leaf;
}

}  // namespace

QuadricTree::QuadricTree(std::vector<ConeTreeItem> given, std::span<const PointSource> sources,
                         double uncertainty, double g) {
    const std::span<ConeTreeItem> items = given;
    const std::size_t leaf_count = (items.size() + leaf_size - 1) / leaf_size;
    std::vector<Metric> inverse_squares(sources.size());
    tbb::parallel_for(std::size_t{0}, items.size(), [&](std::size_t i) {
        const std::uint32_t source = items[i].index;
        inverse_squares[source] = square(inverse(sources[source].metric));
    });
    constexpr std::size_t arity = lane_count;
    std::size_t of_child = 1;  // leaves, at most
    while (arity * of_child < leaf_count) of_child *= arity;
    parents_.push_back(0);
    std::vector<Range> level;
    if (leaf_count > 1) level.push_back({0, leaf_count});
    for (; !level.empty(); of_child /= arity) {
        const std::size_t first = nodes_.size();
        nodes_.resize(first + level.size());
        std::vector<std::array<Range, arity>> children(level.size());
        tbb::parallel_for(std::size_t{0}, level.size(), [&](std::size_t n) {
            std::size_t count = 0;
            cut(items, level[n], (level[n].size() + of_child - 1) / of_child,
                [&](Range leaves) { children[n][count++] = leaves; });
        });
        tbb::parallel_for(std::size_t{0}, arity * level.size(), [&](std::size_t i) {
            const Range leaves = children[i / arity][i % arity];
            if (leaves.size() == 0) return;
            const auto members = items_of<const ConeTreeItem>(leaves, items);
            QuadricNode& node = nodes_[first + i / arity];
            set_child(node, i % arity, members, inverse_squares, uncertainty);
            double least = std::numeric_limits<double>::infinity();
            for (const ConeTreeItem& item : members) {
                least = std::min(least, cone_growth(sources[item.index], g) - 1);
            }
            node.squared_slope[i % arity] = least * least;
        });
        std::vector<Range> below;
        for (std::size_t n = 0; n < level.size(); ++n) {
            const auto number = static_cast<std::uint32_t>(first + n);
            nodes_[number].is_linear = are_linear(nodes_[number]);
            nodes_[number].first_child = static_cast<std::uint32_t>(nodes_.size() + below.size());
            for (const Range& leaves : children[n]) {
                if (leaves.size() == 0) continue;
                ++nodes_[number].child_count;
                parents_.push_back(number);
                below.push_back(leaves);
            }
        }
        if (of_child == 1) break;
        level = std::move(below);
    }
    nodes_.shrink_to_fit();
    parents_.shrink_to_fit();
    indices_.resize(items.size());
    std::ranges::transform(items, indices_.begin(), &ConeTreeItem::index);
    // What is needed no longer is gone before the rest is made.
    given = std::vector<ConeTreeItem>();
    const auto for_each_vector = [&](const auto& make) {
        tbb::parallel_for(std::size_t{0}, vectors_of_leaf * leaf_count, [&](std::size_t v) {
            const std::size_t begin = std::min(lane_count * v, indices_.size());
            const std::size_t end = std::min(begin + lane_count, indices_.size());
            make(v, std::span<const std::uint32_t>(indices_).subspan(begin, end - begin));
        });
    };
    vectors_.resize(vectors_of_leaf * leaf_count);
    for_each_vector([&](std::size_t v, std::span<const std::uint32_t> of) {
        vectors_[v] = quadric_leaf(of, sources, inverse_squares, uncertainty, g);
    });
    inverse_squares = std::vector<Metric>();
    shapes_.resize(vectors_.size());
    for_each_vector([&](std::size_t v, std::span<const std::uint32_t> of) {
        for (std::size_t i = 0; i < of.size(); ++i) {
            const auto lane = static_cast<Eigen::Index>(i);
            shapes_[v].metric.set(lane, sources[of[i]].metric);
            shapes_[v].growth[lane] = cone_growth(sources[of[i]], g);
        }
    });
}

std::size_t QuadricTree::bytes() const {
    return vectors_.capacity() * (sizeof(QuadricLeaf) + sizeof(Shapes)) +
           nodes_.capacity() * sizeof(QuadricNode) +
           (parents_.capacity() + indices_.capacity()) * sizeof(std::uint32_t);
}

}  // namespace controlspace
