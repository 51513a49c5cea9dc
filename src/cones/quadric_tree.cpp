#include "cones/quadric_tree.h"

#include <tbb/parallel_for.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "vector_clones.h"

namespace controlspace {

// The bound of a node
// -------------------
// Write a source's quadratic function at y as q(y) = |M^-1 (p - Q)|^2, and P = H^T M^-2 H: both are
// linear in its ten coefficients. H is within sqrt(limit) times its cone if
//     x P x <= limit (1 + (g-1) sqrt(q(y)))^2    for all unit vectors x.
// For each x the left side is linear, and the right side concave, in the coefficients where q >= 0.
// So the inequality is true in a parallelogram of coefficients if it is true at its four corners,
// and the variation of P, that of q, and their correlation count as they are: where sources vary
// smoothly, only the square of their variation, in `rest`, makes the bound less than sharp. (A
// bound of each of the two sides by itself would lose the first order.) `rest` makes P greater and
// q smaller: in the coordinates of the axes h_j, the rows of H, x P x gains no more than sum
// rest_jk |h_j| |h_k|. If q may be negative at a corner, all factors count as 1, the least.

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
    Eigen::Matrix3d axes;  // columns
    Coefficients middle;
    std::array<Coefficients, 2> slopes;
    Coefficients rest = Coefficients::Zero();
};

// The two directions along which some places vary most, and the sums and bounds of their
// coordinates.
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
    bounds.axes = eigen_frame(Metric::from_matrix(sum)).directions;
    const Eigen::Matrix3d& axes = bounds.axes;
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
        bounds.rest = bounds.rest.max(here.abs());
        greatest = greatest.max(q.abs());
        greatest_trace = std::max(greatest_trace, q[0] + q[1] + q[2]);
        farthest = std::max(farthest, w.squaredNorm());
    }
    // Rounding of A and of the sums here and in `children_exceeded`.
    const double rounding = 64 * std::numeric_limits<double>::epsilon() * greatest_trace;
    for (int j = 0; j < 3; ++j) bounds.rest[j] += rounding + 6 * uncertainty * greatest[j];
    bounds.rest[9] += rounding * farthest + 6 * uncertainty * greatest[9];
    return bounds;
}

// What follows is plain arithmetic, lane by lane, for the compiler to turn into vectors.

struct Symmetric {
    double xx, yy, zz, xy, xz, yz;
};

// A place or a factor as seen along the axes of a child.
struct Frame {
    double x0, x1, x2, y0, y1, y2, z0, z1, z2;  // rows, one for each axis

    [[gnu::always_inline]] inline Frame(const std::array<std::array<QuadricNode::Row, 3>, 3>& axes,
                                        std::size_t l, const std::array<double, 9>& h)
        : x0(axes[0][0][l] * h[0] + axes[0][1][l] * h[3] + axes[0][2][l] * h[6]),
          x1(axes[0][0][l] * h[1] + axes[0][1][l] * h[4] + axes[0][2][l] * h[7]),
          x2(axes[0][0][l] * h[2] + axes[0][1][l] * h[5] + axes[0][2][l] * h[8]),
          y0(axes[1][0][l] * h[0] + axes[1][1][l] * h[3] + axes[1][2][l] * h[6]),
          y1(axes[1][0][l] * h[1] + axes[1][1][l] * h[4] + axes[1][2][l] * h[7]),
          y2(axes[1][0][l] * h[2] + axes[1][1][l] * h[5] + axes[1][2][l] * h[8]),
          z0(axes[2][0][l] * h[0] + axes[2][1][l] * h[3] + axes[2][2][l] * h[6]),
          z1(axes[2][0][l] * h[1] + axes[2][1][l] * h[4] + axes[2][2][l] * h[7]),
          z2(axes[2][0][l] * h[2] + axes[2][1][l] * h[5] + axes[2][2][l] * h[8]) {}

    // Products of the rows.
    [[gnu::always_inline]] inline Symmetric products() const {
        return {x0 * x0 + x1 * x1 + x2 * x2, y0 * y0 + y1 * y1 + y2 * y2,
                z0 * z0 + z1 * z1 + z2 * z2, x0 * y0 + x1 * y1 + x2 * y2,
                x0 * z0 + x1 * z1 + x2 * z2, y0 * z0 + y1 * z1 + y2 * z2};
    }
    // H^T A H.
    [[gnu::always_inline]] inline Symmetric seen(const QuadricNode::Rows& a, std::size_t l) const {
        const double xx = a[0][l], yy = a[1][l], zz = a[2][l];
        const double xy = a[3][l], xz = a[4][l], yz = a[5][l];
        const double u0 = xx * x0 + xy * y0 + xz * z0;
        const double v0 = xy * x0 + yy * y0 + yz * z0;
        const double w0 = xz * x0 + yz * y0 + zz * z0;
        const double u1 = xx * x1 + xy * y1 + xz * z1;
        const double v1 = xy * x1 + yy * y1 + yz * z1;
        const double w1 = xz * x1 + yz * y1 + zz * z1;
        const double u2 = xx * x2 + xy * y2 + xz * z2;
        const double v2 = xy * x2 + yy * y2 + yz * z2;
        const double w2 = xz * x2 + yz * y2 + zz * z2;
        return {x0 * u0 + y0 * v0 + z0 * w0, x1 * u1 + y1 * v1 + z1 * w1,
                x2 * u2 + y2 * v2 + z2 * w2, x0 * u1 + y0 * v1 + z0 * w1,
                x0 * u2 + y0 * v2 + z0 * w2, x1 * u2 + y1 * v2 + z1 * w2};
    }
};

// Sum of the products of all nine entries.
[[gnu::always_inline]] inline double inner_product(const QuadricNode::Rows& a, std::size_t l,
                                                   const Symmetric& b) {
    return a[0][l] * b.xx + a[1][l] * b.yy + a[2][l] * b.zz +
           2 * (a[3][l] * b.xy + a[4][l] * b.xz + a[5][l] * b.yz);
}

// y A y + 2 b y + c.
[[gnu::always_inline]] inline double value(const QuadricNode::Rows& q, std::size_t l, double x,
                                           double y, double z) {
    return x * (q[0][l] * x + 2 * (q[3][l] * y + q[4][l] * z + q[6][l])) +
           y * (q[1][l] * y + 2 * (q[5][l] * z + q[7][l])) + z * (q[2][l] * z + 2 * q[8][l]) +
           q[9][l];
}

[[gnu::always_inline]] inline double positive(double x) { return x > 0 ? x : 0; }
[[gnu::always_inline]] inline double less(double a, double b) { return a < b ? a : b; }

// The least of three numbers that are all positive where most I - P is positive definite, and not
// all where it is not.
[[gnu::always_inline]] inline double least_minor(double most, const Symmetric& p) {
    const double x = most - p.xx;
    const double y = most - p.yy;
    const double z = most - p.zz;
    const double xy = x * y - p.xy * p.xy;
    const double determinant = z * xy - x * p.yz * p.yz - y * p.xz * p.xz - 2 * p.xy * p.xz * p.yz;
    return less(less(x, xy), determinant);
}

// A parallelogram of quadratic functions, and P of its middle and of its variation.
struct Corners {
    double middle, first, second;
    double rest_seen, limit, slope;
    Symmetric p, p_first, p_second;

    [[gnu::always_inline]] inline double room(double s, double t) const {
        const double factor = 1 + slope * std::sqrt(positive(middle + s * first + t * second));
        const double most = limit * factor * factor - rest_seen;
        return least_minor(
            most,
            {p.xx + s * p_first.xx + t * p_second.xx, p.yy + s * p_first.yy + t * p_second.yy,
             p.zz + s * p_first.zz + t * p_second.zz, p.xy + s * p_first.xy + t * p_second.xy,
             p.xz + s * p_first.xz + t * p_second.xz, p.yz + s * p_first.yz + t * p_second.yz});
    }
};

// q and its variation, and what the rest adds to P, of all children.
struct Measured {
    QuadricNode::Row middle, first, second, rest_seen;
    QuadricNode::Row bounds;  // of the eigenvalues, by the trace
};

CONTROLSPACE_VECTOR_CLONES
void measure(const QuadricNode& __restrict node, const std::array<double, 3>& p,
             const std::array<double, 9>& h, double slope, Measured& __restrict measured) {
    for (std::size_t l = 0; l < lane_count; ++l) {
        const double ux = p[0] - node.centre[0][l];
        const double uy = p[1] - node.centre[1][l];
        const double uz = p[2] - node.centre[2][l];
        const double x =
            node.axes[0][0][l] * ux + node.axes[0][1][l] * uy + node.axes[0][2][l] * uz;
        const double y =
            node.axes[1][0][l] * ux + node.axes[1][1][l] * uy + node.axes[1][2][l] * uz;
        const double z =
            node.axes[2][0][l] * ux + node.axes[2][1][l] * uy + node.axes[2][2][l] * uz;
        const double middle = value(node.middle, l, x, y, z) -
                              value(node.rest, l, std::abs(x), std::abs(y), std::abs(z));
        const double first = value(node.slopes[0], l, x, y, z);
        const double second = value(node.slopes[1], l, x, y, z);
        const Symmetric products = Frame(node.axes, l, h).products();
        const double sx = std::sqrt(products.xx);
        const double sy = std::sqrt(products.yy);
        const double sz = std::sqrt(products.zz);
        const Symmetric sizes{products.xx, products.yy, products.zz, sx * sy, sx * sz, sy * sz};
        const double rest_seen = inner_product(node.rest, l, sizes);
        // The trace is no less than the greatest eigenvalue.
        const double trace = inner_product(node.middle, l, products) +
                             std::abs(inner_product(node.slopes[0], l, products)) +
                             std::abs(inner_product(node.slopes[1], l, products));
        const double least =
            1 + slope * std::sqrt(positive(middle - std::abs(first) - std::abs(second)));
        measured.middle[l] = middle;
        measured.first[l] = first;
        measured.second[l] = second;
        measured.rest_seen[l] = rest_seen;
        measured.bounds[l] = (trace + rest_seen) / (least * least);
    }
}

// Numbers that are positive where no eigenvalue at any corner is greater than the limit.
CONTROLSPACE_VECTOR_CLONES
void measure_corners(const QuadricNode& __restrict node, const std::array<double, 9>& h,
                     double limit, double slope, const Measured& __restrict measured,
                     QuadricNode::Row& __restrict rooms) {
    for (std::size_t l = 0; l < lane_count; ++l) {
        const double middle = measured.middle[l];
        const double first = measured.first[l];
        const double second = measured.second[l];
        // Where q may be negative, factors count as 1.
        const double counts = middle - std::abs(first) - std::abs(second) > 0 ? slope : 0;
        const Frame frame(node.axes, l, h);
        const Symmetric p = frame.seen(node.middle, l);
        const Symmetric a = frame.seen(node.slopes[0], l);
        const Symmetric b = frame.seen(node.slopes[1], l);
        const Corners corners{middle, first, second, measured.rest_seen[l], limit, counts, p, a, b};
        rooms[l] = less(less(corners.room(-1, -1), corners.room(-1, 1)),
                        less(corners.room(1, -1), corners.room(1, 1)));
    }
}

void set(QuadricNode::Rows& rows, std::size_t lane, const Coefficients& q) {
    for (std::size_t k = 0; k < rows.size(); ++k) rows[k][lane] = q[static_cast<Eigen::Index>(k)];
}

}  // namespace

ExceededChildren children_exceeded(const QuadricNode& node, const Point& p,
                                   const Eigen::Matrix3d& h, double limit, double slope) {
    const std::array<double, 9> rows{h(0, 0), h(0, 1), h(0, 2), h(1, 0), h(1, 1),
                                     h(1, 2), h(2, 0), h(2, 1), h(2, 2)};
    Measured measured;
    measure(node, {p.x(), p.y(), p.z()}, rows, slope, measured);
    ExceededChildren children{.bits = 0, .bounds = measured.bounds};
    if (std::ranges::all_of(children.bounds, [&](double bound) { return bound < limit; })) {
        return children;
    }
    QuadricNode::Row rooms;
    measure_corners(node, rows, limit, slope, measured, rooms);
    for (std::size_t l = 0; l < rooms.size(); ++l) {
        children.bits |= (rooms[l] > 0 ? 0u : 1u) << l;
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
                    const auto row = static_cast<std::size_t>(a);
                    node.centre[row][i] = bounds.centre[a];
                    for (int j = 0; j < 3; ++j) {
                        node.axes[static_cast<std::size_t>(j)][row][i] = bounds.axes(a, j);
                    }
                }
                set(node.middle, i, bounds.middle);
                for (std::size_t k = 0; k < 2; ++k) set(node.slopes[k], i, bounds.slopes[k]);
                set(node.rest, i, bounds.rest);
            }
        });
    return tree;
}

}  // namespace controlspace
