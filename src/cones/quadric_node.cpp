// SPDX-License-Identifier: Apache-2.0
#include "cones/quadric_node.h"

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "unrolled.h"
#include "vector_clones.h"

namespace controlspace {

// The bound of a node
// -------------------
// Write a source's quadratic function at y as q(y) = |M^-1 (p - Q)|^2, and P =
// H^T M^-2 H: both are linear in its ten coefficients. H is within sqrt(limit)
// times its cone if
//     x P x <= limit (1 + (g-1) sqrt(q(y)))^2    for all unit vectors x.
// For each x the left side is linear, and the right side concave, in the
// coefficients where q >= 0. So the inequality is true in a convex set of
// coefficients if it is true at its corners: the nine control points of the
// patch in Bernstein's form, whose convex hull holds it, or four where it is a
// parallelogram. The variation of P, that of q, and their correlation count as
// they are: where sources vary smoothly, only the third order of their
// variation, in `rest`, and the distance of the control points, make the bound
// less than sharp. (A bound of each of the two sides by itself would lose the
// first order.) `rest` makes P greater and q smaller: in the coordinates of the
// axes h_j, the rows of H, x P x gains no more than sum rest_jk |h_j| |h_k|. If
// q may be negative at a control point, all factors count as 1, the least.

namespace {

// What follows is plain arithmetic, lane by lane, for the compiler to turn into
// vectors.

using Row = QuadricNode::Row;

// y A y + 2 b y + c.
[[gnu::always_inline]] inline double value(const QuadricNode::Rows& q, std::size_t l, double x,
                                           double y, double z) {
    return x * (q[0][l] * x + 2 * (q[3][l] * y + q[4][l] * z + q[6][l])) +
           y * (q[1][l] * y + 2 * (q[5][l] * z + q[7][l])) + z * (q[2][l] * z + 2 * q[8][l]) +
           q[9][l];
}

[[gnu::always_inline]] inline double positive(double x) { return x > 0 ? x : 0; }
[[gnu::always_inline]] inline double less(double a, double b) { return a < b ? a : b; }

struct Symmetric {
    double xx, yy, zz, xy, xz, yz;
};

// The least of three numbers that are all positive where most W - A is positive definite, and not
// all where it is not: its pivots, times those before them. As stable, without divisions.
[[gnu::always_inline]] inline double least_minor(double most, const Metric& w, const Symmetric& a) {
    const double xx = most * w.xx - a.xx;
    const double xy = most * w.xy - a.xy;
    const double xz = most * w.xz - a.xz;
    const double yy = xx * (most * w.yy - a.yy) - xy * xy;
    const double yz = xx * (most * w.yz - a.yz) - xy * xz;
    const double zz = xx * (most * w.zz - a.zz) - xz * xz;
    return less(less(xx, yy), yy * zz - yz * yz);
}

// A square root, or up to 1e-6 less. Those of short numbers take half the time.
[[gnu::always_inline]] inline double nearly_root(double x) {
    constexpr double most = 1e30;
    constexpr double below = 1 - 5e-7;
    return below * static_cast<double>(std::sqrt(static_cast<float>(less(x, most))));
}

// Of a patch, a number at each control point.
template <int points>
struct Patch {
    static constexpr bool is_linear = points == 4;
    // Values of term k: v(k).
    template <class Value>
    [[gnu::always_inline]] inline static std::array<double, points> of(const Value& v) {
        if constexpr (is_linear) {
            const double low = v(0) - v(2);
            const double high = v(0) + v(2);
            return {low - v(1), low + v(1), high - v(1), high + v(1)};
        } else {
            const double low = v(0) - v(2) + v(5);
            const double mid = v(0) - v(5);
            const double high = v(0) + v(2) + v(5);
            const double to_low = v(1) - v(4);
            const double to_high = v(1) + v(4);
            return {low - to_low + v(3),   low - v(3),  low + to_low + v(3),
                    mid - v(1) + v(3),     mid - v(3),  mid + v(1) + v(3),
                    high - to_high + v(3), high - v(3), high + to_high + v(3)};
        }
    }
};

// Numbers that are positive where no eigenvalue at any control point is greater than the limit.
template <int points>
[[gnu::always_inline]] inline void measure_rooms(const QuadricNode& __restrict node,
                                                 const Exceeding& __restrict h, double limit,
                                                 Row& __restrict rooms) {
    for (std::size_t l = 0; l < lane_count; ++l) {
        const double x = h.p.x() - node.centre[0][l];
        const double y = h.p.y() - node.centre[1][l];
        const double z = h.p.z() - node.centre[2][l];
        const double rest =
            x * (node.rest[0][l] * x + 2 * (node.rest[3][l] * y + node.rest[4][l] * z)) +
            y * (node.rest[1][l] * y + 2 * node.rest[5][l] * z) + z * node.rest[2][l] * z +
            2 * node.rest[6][l] * std::sqrt(x * x + y * y + z * z) + node.rest[7][l];
        const auto q = Patch<points>::of([&](std::size_t k) __attribute__((always_inline)) {
            return value(node.terms[k], l, x, y, z) - (k == 0 ? rest : 0.0);
        });
        double least = q[0];
        unrolled<points>([&](auto i) __attribute__((always_inline)) { least = less(least, q[i]); });
        // If q may be negative, it counts as 0.
        const double counts = least > 0 ? node.squared_slope[l] : 0;
        std::array<std::array<double, points>, 6> a;
        unrolled<6>([&](auto e) __attribute__((always_inline)) {
            a[e] = Patch<points>::of([&](std::size_t k) __attribute__((always_inline)) {
                return k == 0 ? node.terms[k][e][l] + node.rest[e][l] : node.terms[k][e][l];
            });
        });
        double room = std::numeric_limits<double>::infinity();
        unrolled<points>([&](auto i) __attribute__((always_inline)) {
            const double factor = 1 + nearly_root(counts * positive(q[i]));
            room = less(room, least_minor(limit * factor * factor, h.inverse,
                                          {a[0][i], a[1][i], a[2][i], a[3][i], a[4][i], a[5][i]}));
        });
        rooms[l] = room;
    }
}

// As above, where terms are those of one source each.
[[gnu::always_inline]] inline void measure_rooms(const QuadricLeaf& __restrict leaf,
                                                 const Exceeding& __restrict h, double limit,
                                                 Row& __restrict rooms) {
    for (std::size_t l = 0; l < lane_count; ++l) {
        const double x = h.p.x() - leaf.position.x[static_cast<Eigen::Index>(l)];
        const double y = h.p.y() - leaf.position.y[static_cast<Eigen::Index>(l)];
        const double z = h.p.z() - leaf.position.z[static_cast<Eigen::Index>(l)];
        const double doubt = leaf.doubt[l];
        const Symmetric a{leaf.terms[0][l], leaf.terms[1][l], leaf.terms[2][l],
                          leaf.terms[3][l], leaf.terms[4][l], leaf.terms[5][l]};
        const double q = x * (a.xx * x + 2 * (a.xy * y + a.xz * z)) +
                         y * (a.yy * y + 2 * a.yz * z) + z * a.zz * z -
                         doubt * (x * x + y * y + z * z);
        const double factor = 1 + nearly_root(leaf.squared_slope[l] * positive(q));
        rooms[l] = least_minor(limit * factor * factor, h.inverse,
                               {a.xx + doubt, a.yy + doubt, a.zz + doubt, a.xy, a.xz, a.yz});
    }
}

template <int points>
[[gnu::always_inline]] inline ExceededChildren exceeded_of(const QuadricNode& node,
                                                           const Exceeding& h, double limit) {
    ExceededChildren children;
    measure_rooms<points>(node, h, limit, children.rooms);
    for (std::size_t l = 0; l < lane_count; ++l) {
        children.bits |= (children.rooms[l] > 0 ? 0u : 1u) << l;
    }
    children.bits &= (1u << node.child_count) - 1;
    return children;
}

CONTROLSPACE_VECTOR_CLONES
bool of_sources(const QuadricLeaf& leaf, const Exceeding& h, double limit) {
    Row rooms;
    measure_rooms(leaf, h, limit, rooms);
    bool exceeds = false;
    for (std::size_t l = 0; l < lane_count; ++l) exceeds |= !(rooms[l] > 0);
    return exceeds;
}

CONTROLSPACE_VECTOR_CLONES
ExceededChildren of_parallelograms(const QuadricNode& node, const Exceeding& h, double limit) {
    return exceeded_of<4>(node, h, limit);
}

CONTROLSPACE_VECTOR_CLONES
ExceededChildren of_patches(const QuadricNode& node, const Exceeding& h, double limit) {
    return exceeded_of<9>(node, h, limit);
}

}  // namespace

Exceeding::Exceeding(const Point& place, const Eigen::Matrix3d& h) : p(place), factor(h) {
    const Eigen::Matrix3d inverse_factor = h.partialPivLu().inverse();
    inverse = Metric::from_matrix(inverse_factor.transpose() * inverse_factor);
    // Less than it is, by what rounding of minors leaves in doubt.
    constexpr double rounding = 64 * std::numeric_limits<double>::epsilon();
    const double doubt = rounding * (inverse.xx + inverse.yy + inverse.zz);
    inverse.xx -= doubt;
    inverse.yy -= doubt;
    inverse.zz -= doubt;
}

ExceededChildren children_exceeded(const QuadricNode& node, const Exceeding& h, double limit) {
    return node.is_linear ? of_parallelograms(node, h, limit) : of_patches(node, h, limit);
}

bool may_exceed(const QuadricLeaf& leaf, const Exceeding& h, double limit) {
    return of_sources(leaf, h, limit);
}

}  // namespace controlspace
