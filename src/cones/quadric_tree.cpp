#include "cones/quadric_tree.h"

#include <tbb/parallel_for.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "vector_clones.h"

namespace controlspace {

// The bound of a node
// -------------------
// Write a source's quadratic function at y as q(y) = |M^-1 (p - Q)|^2, and P =
// H^T M^-2 H: both are linear in its ten coefficients. H is within sqrt(limit)
// times its cone if
//     x P x <= limit (1 + (g-1) sqrt(q(y)))^2    for all unit vectors x.
// For each x the left side is linear, and the right side concave, in the
// coefficients where q >= 0. So the inequality is true in a parallelogram of
// coefficients if it is true at its four corners, and the variation of P, that
// of q, and their correlation count as they are: where sources vary smoothly,
// only the square of their variation, in `rest`, makes the bound less than
// sharp. (A bound of each of the two sides by itself would lose the first
// order.) `rest` makes P greater and q smaller: in the coordinates of the axes
// h_j, the rows of H, x P x gains no more than sum rest_jk |h_j| |h_k|. If q
// may be negative at a corner, all factors count as 1, the least.

namespace {

using Coefficients = Eigen::Array<double, 10, 1>;  // xx yy zz xy xz yz, x y z, 1

Coefficients coefficients_of(const Eigen::Matrix3d& a, const Vector& w) {
    const Vector b = -(a * w);
    Coefficients q;
    q << a(0, 0), a(1, 1), a(2, 2), a(1, 0), a(2, 0), a(2, 1), b.array(), -b.dot(w);
    return q;
}

struct Bounds {
    Point centre = Point::Zero();
    Coefficients middle;
    std::array<Coefficients, 2> slopes;
    std::array<double, 8> rest;
};

// The two directions along which some places vary most, and the sums and bounds
// of their coordinates.
struct Parameters {
    std::array<Vector, 2> directions;
    std::array<double, 2> squares{}, low{}, high{};

    double middle(std::size_t k) const { return 0.5 * (high[k] + low[k]); }
    double reach(std::size_t k) const { return 0.5 * (high[k] - low[k]); }
};

Bounds bounds_of(std::span<const ConeTreeItem> items, std::span<const Metric> inverse_squares,
                 double uncertainty) {
    Bounds bounds;
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (const ConeTreeItem& item : items) {
        bounds.centre += item.position();
        sum += inverse_squares[item.index].matrix();
    }
    const double share = 1 / static_cast<double>(items.size());
    bounds.centre *= share;
    // Least variation of second order in its own axes.
    const Eigen::Matrix3d axes = eigen_frame(Metric::from_matrix(sum)).directions;
    const auto place = [&](const ConeTreeItem& item) -> Vector {
        return axes.transpose() * (item.position() - bounds.centre);
    };
    const auto coefficients = [&](const ConeTreeItem& item, const Vector& w) {
        return coefficients_of(axes.transpose() * inverse_squares[item.index].matrix() * axes, w);
    };

    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const ConeTreeItem& item : items) {
        const Vector w = place(item);
        covariance += w * w.transpose();
    }
    const Eigen::Matrix3d principal = eigen_frame(Metric::from_matrix(covariance)).directions;
    Parameters along;
    along.directions = {principal.col(2), principal.col(1)};

    // Least squares: the functions over the coordinates of the places.
    const Coefficients first = coefficients(items.front(), place(items.front()));
    bounds.middle.setZero();
    std::array<Coefficients, 2> moments{Coefficients::Zero(), Coefficients::Zero()};
    for (const ConeTreeItem& item : items) {
        const Vector w = place(item);
        const Coefficients q = coefficients(item, w) - first;
        bounds.middle += q;
        for (std::size_t k = 0; k < 2; ++k) {
            const double x = along.directions[k].dot(w);
            moments[k] += x * q;
            along.squares[k] += x * x;
            along.low[k] = std::min(along.low[k], x);
            along.high[k] = std::max(along.high[k], x);
        }
    }
    bounds.middle = first + share * bounds.middle;
    constexpr double flat = 1e-10;
    for (std::size_t k = 0; k < 2; ++k) {
        bounds.slopes[k].setZero();
        if (!(along.squares[k] > flat * along.squares[0])) continue;
        const Coefficients slope = moments[k] / along.squares[k];
        bounds.middle += along.middle(k) * slope;
        bounds.slopes[k] = along.reach(k) * slope;
    }

    Coefficients rest = Coefficients::Zero();
    Coefficients greatest = Coefficients::Zero();
    double greatest_trace = 0;
    double farthest = 0;
    for (const ConeTreeItem& item : items) {
        const Vector w = place(item);
        const Coefficients q = coefficients(item, w);
        Coefficients here = q - bounds.middle;
        for (std::size_t k = 0; k < 2; ++k) {
            const double reach = along.reach(k);
            if (!(reach > 0)) continue;
            const double x = (along.directions[k].dot(w) - along.middle(k)) / reach;
            here -= std::clamp(x, -1.0, 1.0) * bounds.slopes[k];
        }
        rest = rest.max(here.abs());
        greatest = greatest.max(q.abs());
        greatest_trace = std::max(greatest_trace, q[0] + q[1] + q[2]);
        farthest = std::max(farthest, w.squaredNorm());
    }
    // Rounding of A and of the sums here and in `children_exceeded`.
    const double rounding = 64 * std::numeric_limits<double>::epsilon() * greatest_trace;
    for (int j = 0; j < 3; ++j) rest[j] += rounding + 6 * uncertainty * greatest[j];
    rest[9] += rounding * farthest + 6 * uncertainty * greatest[9];
    // |x_j x_k| <= (x_j^2 + x_k^2) / 2: a tensor of the rows' sums is no less.
    const Vector sums(rest[0] + rest[3] + rest[4], rest[1] + rest[3] + rest[5],
                      rest[2] + rest[4] + rest[5]);
    const Metric g = Metric::from_matrix(axes * sums.asDiagonal() * axes.transpose());
    bounds.rest = {g.xx, g.yy, g.zz, g.xy, g.xz, g.yz, rest.segment<3>(6).matrix().norm(), rest[9]};
    const auto unrotated = [&](const Coefficients& q) -> Coefficients {
        const Eigen::Matrix3d a =
            axes * Metric{q[0], q[1], q[2], q[3], q[4], q[5]}.matrix() * axes.transpose();
        const Vector b = axes * Vector(q[6], q[7], q[8]);
        Coefficients rotated;
        rotated << a(0, 0), a(1, 1), a(2, 2), a(1, 0), a(2, 0), a(2, 1), b.array(), q[9];
        return rotated;
    };
    bounds.middle = unrotated(bounds.middle);
    for (Coefficients& slope : bounds.slopes) slope = unrotated(slope);
    return bounds;
}

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

// Sum of the products of all nine entries.
[[gnu::always_inline]] inline double inner_product(const Row* a, std::size_t l, const Metric& b) {
    return a[0][l] * b.xx + a[1][l] * b.yy + a[2][l] * b.zz +
           2 * (a[3][l] * b.xy + a[4][l] * b.xz + a[5][l] * b.yz);
}

[[gnu::always_inline]] inline double positive(double x) { return x > 0 ? x : 0; }
[[gnu::always_inline]] inline double less(double a, double b) { return a < b ? a : b; }

// (g-1)^2 q of all children, and whether traces decide.
struct Measured {
    Row middle, first, second;
    Row rooms;  // positive where no trace at any corner is greater than the limit
};

// Of a parallelogram, the trace of P over the limit, and (g-1)^2 q.
struct Traces {
    double middle, first, second;
    double q_middle, q_first, q_second;

    // Positive where trace / limit < (1 + sqrt(q))^2.
    [[gnu::always_inline]] inline double room(double s, double t) const {
        const double q = q_middle + s * q_first + t * q_second;
        const double more = middle + s * first + t * second - 1 - q;
        return 4 * q - more * std::abs(more);
    }
};

CONTROLSPACE_VECTOR_CLONES
void measure(const QuadricNode& __restrict node, const Exceeding& __restrict h, double limit,
             Measured& __restrict measured) {
    const double squared_slope = h.slope * h.slope;
    const double over_limit = 1 / limit;
    for (std::size_t l = 0; l < lane_count; ++l) {
        const double x = h.p.x() - node.centre[0][l];
        const double y = h.p.y() - node.centre[1][l];
        const double z = h.p.z() - node.centre[2][l];
        const double rest =
            x * (node.rest[0][l] * x + 2 * (node.rest[3][l] * y + node.rest[4][l] * z)) +
            y * (node.rest[1][l] * y + 2 * node.rest[5][l] * z) + z * node.rest[2][l] * z +
            2 * node.rest[6][l] * std::sqrt(x * x + y * y + z * z) + node.rest[7][l];
        const double middle = value(node.middle, l, x, y, z) - rest;
        const double first = value(node.slopes[0], l, x, y, z);
        const double second = value(node.slopes[1], l, x, y, z);
        // If q may be negative, it counts as 0.
        const double counts = middle - std::abs(first) - std::abs(second) > 0 ? squared_slope : 0;
        const Metric& square = h.square;
        const Traces traces{over_limit * (inner_product(node.middle.data(), l, square) +
                                          inner_product(node.rest.data(), l, square)),
                            over_limit * inner_product(node.slopes[0].data(), l, square),
                            over_limit * inner_product(node.slopes[1].data(), l, square),
                            counts * middle,
                            counts * first,
                            counts * second};
        measured.middle[l] = traces.q_middle;
        measured.first[l] = traces.q_first;
        measured.second[l] = traces.q_second;
        measured.rooms[l] = less(less(traces.room(-1, -1), traces.room(-1, 1)),
                                 less(traces.room(1, -1), traces.room(1, 1)));
    }
}

struct Symmetric {
    double xx, yy, zz, xy, xz, yz;
};

// The least of three numbers that are all positive where most W - A is positive definite, and not
// all where it is not, made less by what rounding leaves in doubt. Its pivots, times those before
// them: as stable, without divisions.
[[gnu::always_inline]] inline double least_minor(double most, const Metric& w, const Symmetric& a) {
    constexpr double rounding = 64 * std::numeric_limits<double>::epsilon();
    const double doubt = rounding * most * (w.xx + w.yy + w.zz);
    const double xx = most * w.xx - a.xx - doubt;
    const double xy = most * w.xy - a.xy;
    const double xz = most * w.xz - a.xz;
    const double yy = xx * (most * w.yy - a.yy - doubt) - xy * xy;
    const double yz = xx * (most * w.yz - a.yz) - xy * xz;
    const double zz = xx * (most * w.zz - a.zz - doubt) - xz * xz;
    return less(less(xx, yy), yy * zz - yz * yz);
}

// A parallelogram: (g-1)^2 q, and A, of its middle and of its variation.
struct Corners {
    double q_middle, q_first, q_second;
    Symmetric middle, first, second;

    [[gnu::always_inline]] inline double room(const Exceeding& h, double limit, double s,
                                              double t) const {
        const double factor = 1 + std::sqrt(positive(q_middle + s * q_first + t * q_second));
        return least_minor(
            limit * factor * factor, h.inverse,
            {middle.xx + s * first.xx + t * second.xx, middle.yy + s * first.yy + t * second.yy,
             middle.zz + s * first.zz + t * second.zz, middle.xy + s * first.xy + t * second.xy,
             middle.xz + s * first.xz + t * second.xz, middle.yz + s * first.yz + t * second.yz});
    }
};

// Numbers that are positive where no eigenvalue at any corner is greater than
// the limit.
CONTROLSPACE_VECTOR_CLONES
void measure_corners(const QuadricNode& __restrict node, const Exceeding& __restrict h,
                     double limit, const Measured& __restrict measured, Row& __restrict rooms) {
    for (std::size_t l = 0; l < lane_count; ++l) {
        const Symmetric middle{
            node.middle[0][l] + node.rest[0][l], node.middle[1][l] + node.rest[1][l],
            node.middle[2][l] + node.rest[2][l], node.middle[3][l] + node.rest[3][l],
            node.middle[4][l] + node.rest[4][l], node.middle[5][l] + node.rest[5][l]};
        const QuadricNode::Rows& first = node.slopes[0];
        const QuadricNode::Rows& second = node.slopes[1];
        const Symmetric a{first[0][l], first[1][l], first[2][l],
                          first[3][l], first[4][l], first[5][l]};
        const Symmetric b{second[0][l], second[1][l], second[2][l],
                          second[3][l], second[4][l], second[5][l]};
        const Corners corners{
            measured.middle[l], measured.first[l], measured.second[l], middle, a, b};
        rooms[l] = less(less(corners.room(h, limit, -1, -1), corners.room(h, limit, -1, 1)),
                        less(corners.room(h, limit, 1, -1), corners.room(h, limit, 1, 1)));
    }
}

void set(QuadricNode::Rows& rows, std::size_t lane, const Coefficients& q) {
    for (std::size_t k = 0; k < rows.size(); ++k) rows[k][lane] = q[static_cast<Eigen::Index>(k)];
}

}  // namespace

Exceeding::Exceeding(const Point& place, const Eigen::Matrix3d& h, double slope_of_cones)
    : p(place), slope(slope_of_cones), square(Metric::from_matrix(h * h.transpose())) {
    const Eigen::Matrix3d inverse_factor = h.inverse();
    inverse = Metric::from_matrix(inverse_factor.transpose() * inverse_factor);
}

ExceededChildren children_exceeded(const QuadricNode& node, const Exceeding& h, double limit) {
    Measured measured;
    measure(node, h, limit, measured);
    const auto is_positive = [](double room) { return room > 0; };
    if (std::ranges::all_of(measured.rooms, is_positive)) return {};
    ExceededChildren children;
    measure_corners(node, h, limit, measured, children.rooms);
    for (std::size_t l = 0; l < lane_count; ++l) {
        const bool is_there = node.middle[0][l] > 0;
        children.bits |= (!is_there || children.rooms[l] > 0 ? 0u : 1u) << l;
    }
    return children;
}

QuadricTree build_quadric_tree(std::span<ConeTreeItem> items, std::span<const PointSource> sources,
                               std::span<const double> lengths, double uncertainty) {
    std::vector<Metric> inverse_squares(sources.size());
    tbb::parallel_for(std::size_t{0}, items.size(), [&](std::size_t i) {
        const std::uint32_t source = items[i].index;
        inverse_squares[source] = square(inverse(sources[source].metric));
    });
    QuadricTree tree;
    tree.build(
        items, lane_count,
        [&](std::span<const ConeTreeItem> of_leaf, TensorLeaf& leaf) {
            leaf = tensor_leaf(of_leaf, sources, lengths);
        },
        [&](std::span<const QuadricTree::Child> children, QuadricNode& node, std::uint32_t) {
            for (std::size_t i = 0; i < children.size(); ++i) {
                if (children[i].items.empty()) continue;
                const Bounds bounds = bounds_of(children[i].items, inverse_squares, uncertainty);
                for (int a = 0; a < 3; ++a) {
                    node.centre[static_cast<std::size_t>(a)][i] = bounds.centre[a];
                }
                set(node.middle, i, bounds.middle);
                for (std::size_t k = 0; k < 2; ++k) set(node.slopes[k], i, bounds.slopes[k]);
                for (std::size_t k = 0; k < 8; ++k) node.rest[k][i] = bounds.rest[k];
            }
        });
    return tree;
}

}  // namespace controlspace
