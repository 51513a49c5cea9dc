// SPDX-License-Identifier: Apache-2.0
#include "cones/exceeded_cones.h"

#include <bit>

#include "metric/constraint_lanes.h"
#include "metric/decompose.h"

namespace controlspace {
namespace {

// Nearly the direction of the greatest eigenvalue, if that is much greater than
// the others.
Vector main_direction(const Metric& tensor) {
    const Eigen::Matrix3d squared = square(tensor).matrix();
    Eigen::Index most = 0;
    squared.diagonal().maxCoeff(&most);
    return squared.col(most).normalized();
}

// Cones of eight sources, and H seen from their metrics.
struct Seen {
    Lanes squared;  // factors of the cones
    TensorLanes tensors;

    Seen(const QuadricTree& tree, std::size_t vector, const Exceeding& exceeding) {
        const auto& [metric, growth] = tree.shapes()[vector];
        const CholeskyLanes<lane_count> factorisation(metric);
        const auto [x, y, z] =
            factorisation.solve(displacements(tree.vectors()[vector].position, exceeding.p));
        const Lanes factor = 1 + (growth - 1) * (x.square() + y.square() + z.square()).sqrt();
        squared = factor.square();
        tensors = seen_from(exceeding.factor, factorisation);
    }
};

void find_in_vector(const QuadricTree& tree, std::uint32_t vector, const Exceeding& exceeding,
                    Exceeded& exceeded) {
    const auto [squared, seen] = Seen(tree, vector, exceeding);
    const Lanes most = exceeded.limit() * squared;
    if ((seen.xx + seen.yy + seen.zz <= most).all()) return;
    const Lanes room = least_minor(most, seen);
    if ((room > 0).all()) return;
    const Lanes growths = greatest_eigenvalues(seen) / squared;
    for (std::uint32_t lane = 0; lane < lane_count; ++lane) {
        const std::uint32_t member = vector * lane_count + lane;
        if (room[lane] > 0 || !(growths[lane] > exceeded.limit())) continue;
        if (member >= tree.indices().size()) continue;
        exceeded.enter({growths[lane], member, main_direction(seen[lane])});
    }
}

}  // namespace

void find_exceeded(const QuadricTree& tree, std::uint32_t root,
                   std::span<const std::uint32_t> except, const Exceeding& exceeding,
                   Exceeded& exceeded) {
    if (std::ranges::find(except, root) != except.end()) return;
    // Seven siblings wait at each of at most eleven levels.
    std::array<std::uint32_t, 96> stack;
    std::size_t height = 0;
    stack[height++] = root;
    while (height > 0) {
        const std::uint32_t number = stack[--height];
        if (tree.is_leaf(number)) {
            const std::uint32_t first = tree.first_vector(number);
            for (std::uint32_t v = first; v < first + QuadricTree::vectors_of_leaf; ++v) {
                if (!may_exceed(tree.vectors()[v], exceeding, exceeded.limit())) continue;
                find_in_vector(tree, v, exceeding, exceeded);
            }
            continue;
        }
        const QuadricNode& node = tree.node(number);
        const std::uint32_t first = node.first_child;
        auto [children, rooms] = children_exceeded(node, exceeding, exceeded.limit());
        const std::size_t floor = height;
        for (; children != 0; children &= children - 1) {
            const auto c = static_cast<std::uint32_t>(std::countr_zero(children));
            if (std::ranges::find(except, first + c) != except.end()) continue;
            // The greatest on top: what is found there raises the limit.
            std::size_t place = height++;
            for (; place > floor && rooms[stack[place - 1] - first] < rooms[c]; --place) {
                stack[place] = stack[place - 1];
            }
            stack[place] = first + c;
        }
    }
}

AllExceeded::AllExceeded(const QuadricTree& tree)
    : tree_(tree),
      is_found_(tree.indices().size(), 0),
      are_found_(
          tree.empty() ? 0 : tree.leaf_of(0) + tree.vectors().size() / QuadricTree::vectors_of_leaf,
          0) {}

void AllExceeded::add(const Exceeding& exceeding) {
    if (!tree_.empty()) add_below(0, exceeding);
}

// Returns whether all sources below have been found.
bool AllExceeded::add_below(std::uint32_t number, const Exceeding& exceeding) {
    if (are_found_[number] != 0) return true;
    bool are_all = true;
    if (tree_.is_leaf(number)) {
        const std::uint32_t first = tree_.first_vector(number);
        for (std::uint32_t v = first; v < first + QuadricTree::vectors_of_leaf; ++v) {
            const std::size_t begin =
                std::min<std::size_t>(std::size_t{v} * lane_count, is_found_.size());
            const std::size_t end = std::min<std::size_t>(begin + lane_count, is_found_.size());
            const auto found = std::span(is_found_).subspan(begin, end - begin);
            if (std::ranges::find(found, 0) == found.end()) continue;
            if (may_exceed(tree_.vectors()[v], exceeding, 1)) {
                const Seen seen(tree_, v, exceeding);
                const Lanes room = least_minor(seen.squared, seen.tensors);
                for (std::size_t lane = 0; lane < found.size(); ++lane) {
                    if (!(room[static_cast<Eigen::Index>(lane)] > 0)) found[lane] = 1;
                }
            }
            are_all = are_all && std::ranges::find(found, 0) == found.end();
        }
    } else {
        const QuadricNode& node = tree_.node(number);
        const unsigned children = children_exceeded(node, exceeding, 1).bits;
        for (std::uint32_t c = 0; c < node.child_count; ++c) {
            const std::uint32_t child = node.first_child + c;
            const bool are_found =
                (children >> c & 1) != 0 ? add_below(child, exceeding) : are_found_[child] != 0;
            are_all = are_all && are_found;
        }
    }
    are_found_[number] = are_all ? 1 : 0;
    return are_all;
}

}  // namespace controlspace
