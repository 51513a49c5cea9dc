#include "cones/exceeded_cones.h"

#include <bit>
#include <cmath>

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

void find_in_vector(const TensorLeaf& leaf, std::uint32_t first_member, const Exceeding& exceeding,
                    Exceeded& exceeded) {
    const CholeskyLanes<lane_count> factorisation(leaf.metric);
    const auto [x, y, z] = factorisation.solve(displacements(leaf.position, exceeding.p));
    const Lanes factor = 1 + (leaf.growth - 1) * (x.square() + y.square() + z.square()).sqrt();
    const Lanes squared = factor.square();
    const TensorLanes seen = seen_from(exceeding.factor, factorisation);
    const Lanes most = exceeded.limit() * squared;
    if ((seen.xx + seen.yy + seen.zz <= most).all()) return;
    const Lanes room = least_minor(most, seen);
    if ((room > 0).all()) return;
    const Lanes growths = greatest_eigenvalues(seen) / squared;
    for (int lane = 0; lane < lane_count; ++lane) {
        if (room[lane] > 0 || !(growths[lane] > exceeded.limit())) continue;
        if (!std::isfinite(leaf.length[lane])) continue;
        exceeded.enter({growths[lane], first_member + static_cast<std::uint32_t>(lane),
                        main_direction(seen[lane])});
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
                if (!may_exceed(tree.leaves()[v], exceeding, exceeded.limit())) continue;
                find_in_vector(tree.vectors()[v], v * lane_count, exceeding, exceeded);
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

}  // namespace controlspace
