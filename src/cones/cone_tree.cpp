// SPDX-License-Identifier: Apache-2.0
#include "cones/cone_tree.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>

namespace controlspace {

ConeTreeShape ConeTreeShape::with_leaves_of(std::uint64_t size, std::uint64_t leaf_size) {
    const std::uint64_t leaves = (size + leaf_size - 1) / leaf_size;
    const int depth = leaves > 1 ? static_cast<int>(std::bit_width(leaves - 1)) : 0;
    return {size, leaf_size, leaves, depth};
}

namespace {

std::size_t longest_extent(std::span<const ConeTreeItem> items) {
    std::array<double, 4> low = items.front().coordinates;
    std::array<double, 4> high = low;
    for (const ConeTreeItem& item : items) {
        for (std::size_t a = 0; a < 4; ++a) {
            low[a] = std::min(low[a], item.coordinates[a]);
            high[a] = std::max(high[a], item.coordinates[a]);
        }
    }
    std::size_t longest = 0;
    for (std::size_t a = 1; a < 4; ++a) {
        if (high[a] - low[a] > high[longest] - low[longest]) longest = a;
    }
    return longest;
}

}  // namespace

void cut_longest_extent(std::span<ConeTreeItem> items, std::size_t middle) {
    const std::size_t axis = longest_extent(items);
    std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(middle),
                     items.end(), [axis](const ConeTreeItem& a, const ConeTreeItem& b) {
                         return a.coordinates[axis] < b.coordinates[axis];
                     });
}

namespace {

void sort_below(const ConeTreeShape& shape, std::uint32_t node, std::span<ConeTreeItem> items) {
    if (shape.is_slot(node)) return;
    const std::size_t begin = shape.begin(node);
    const std::size_t middle = shape.end(2 * node);
    const std::size_t end = shape.end(node);
    const auto of_node = items.subspan(begin, end - begin);
    cut_longest_extent(of_node, middle - begin);
    const auto low = [&] { sort_below(shape, 2 * node, items); };
    const auto high = [&] { sort_below(shape, 2 * node + 1, items); };
    constexpr std::size_t worth_a_task = 4096;
    if (end - begin < worth_a_task) {
        low();
        high();
    } else {
        tbb::parallel_invoke(low, high);
    }
}

}  // namespace

void sort_for_tree(const ConeTreeShape& shape, std::span<ConeTreeItem> items) {
    sort_below(shape, 1, items);
}

}  // namespace controlspace
