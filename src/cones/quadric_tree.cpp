#include "cones/quadric_tree.h"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>
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

using Coefficients = Eigen::Array<double, 10, 1>;  // xx yy zz xy xz yz, x y z, 1

Coefficients coefficients_of(const Eigen::Matrix3d& a, const Vector& w) {
    const Vector b = -(a * w);
    Coefficients q;
    q << a(0, 0), a(1, 1), a(2, 2), a(1, 0), a(2, 0), a(2, 1), b.array(), -b.dot(w);
    return q;
}

constexpr auto term_count = static_cast<Eigen::Index>(QuadricNode::term_count);
using Terms = Eigen::Array<double, 10, term_count>;
using Basis = Eigen::Matrix<double, term_count, 1>;

struct Bounds {
    Point centre = Point::Zero();
    Terms terms;
    std::array<double, 8> rest;
};

// Places as s and t: along the two directions in which they vary most.
class Parameters {
public:
    Parameters(std::span<const ConeTreeItem> items, const Point& centre) {
        Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
        for (const ConeTreeItem& item : items) {
            const Vector v = item.position() - centre;
            covariance += v * v.transpose();
        }
        const EigenFrame frame = eigen_frame(Metric::from_matrix(covariance));
        constexpr double flat = 1e-10;
        for (int k = 0; k < 2; ++k) {
            if (!(frame.lengths[static_cast<std::size_t>(2 - k)] > flat * frame.lengths[2])) break;
            const Vector direction = frame.directions.col(2 - k);
            double low = 0;
            double high = 0;
            for (const ConeTreeItem& item : items) {
                const double x = direction.dot(item.position() - centre);
                low = std::min(low, x);
                high = std::max(high, x);
            }
            if (!(high > low)) break;
            directions_.col(k) = 2 / (high - low) * direction;
            offsets_[k] = -(high + low) / (high - low) - directions_.col(k).dot(centre);
        }
    }
    Basis basis(const Point& place) const {
        const Eigen::Array2d x =
            (directions_.transpose() * place + offsets_).array().max(-1).min(1);
        Basis basis;
        basis << 1, x[0], x[1], x[0] * x[0], x[0] * x[1], x[1] * x[1];
        return basis;
    }

private:
    Eigen::Matrix<double, 3, 2> directions_ = Eigen::Matrix<double, 3, 2>::Zero();
    Eigen::Vector2d offsets_ = Eigen::Vector2d::Zero();
};

Bounds bounds_of(std::span<const ConeTreeItem> items, std::span<const Metric> inverse_squares,
                 double uncertainty) {
    Bounds bounds;
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (const ConeTreeItem& item : items) {
        bounds.centre += item.position();
        sum += inverse_squares[item.index].matrix();
    }
    bounds.centre /= static_cast<double>(items.size());
    // Least variation of third order in its own axes.
    const Eigen::Matrix3d axes = eigen_frame(Metric::from_matrix(sum)).directions;
    const auto place = [&](const ConeTreeItem& item) -> Vector {
        return axes.transpose() * (item.position() - bounds.centre);
    };
    const auto coefficients = [&](const ConeTreeItem& item, const Vector& w) {
        return coefficients_of(axes.transpose() * inverse_squares[item.index].matrix() * axes, w);
    };

    const Parameters parameters(items, bounds.centre);
    // Least squares: the functions over the parameters.
    const Coefficients first = coefficients(items.front(), place(items.front()));
    using Square = Eigen::Matrix<double, term_count, term_count>;
    Square squares = Square::Zero();
    Terms moments = Terms::Zero();
    for (const ConeTreeItem& item : items) {
        const Coefficients q = coefficients(item, place(item)) - first;
        const Basis basis = parameters.basis(item.position());
        squares += basis * basis.transpose();
        moments += (q.matrix() * basis.transpose()).array();
    }
    const auto fitted = [&](Eigen::Index order) {
        Terms terms = Terms::Zero();
        // So that what places do not tell is 0.
        Square regular = squares;
        regular.diagonal().head<3>().array() += 1e-12 * squares(0, 0);
        regular.diagonal().tail<3>().array() += 1e-4 * squares(0, 0);
        terms.leftCols(order) = regular.topLeftCorner(order, order)
                                    .llt()
                                    .solve(moments.leftCols(order).matrix().transpose())
                                    .transpose()
                                    .array();
        terms.col(0) += first;
        return terms;
    };
    struct Rest {
        Coefficients most = Coefficients::Zero();
        Coefficients greatest = Coefficients::Zero();
        double greatest_trace = 0;
        double farthest = 0;
    };
    const auto rest_of = [&](const Terms& terms) {
        Rest rest;
        for (const ConeTreeItem& item : items) {
            const Vector w = place(item);
            const Coefficients q = coefficients(item, w);
            const Coefficients near = (terms.matrix() * parameters.basis(item.position())).array();
            rest.most = rest.most.max((q - near).abs());
            rest.greatest = rest.greatest.max(q.abs());
            rest.greatest_trace = std::max(rest.greatest_trace, q[0] + q[1] + q[2]);
            rest.farthest = std::max(rest.farthest, w.squaredNorm());
        }
        return rest;
    };
    const auto size_of = [](const Rest& rest) {
        return rest.most.head<3>().sum() + 2 * rest.most.segment<3>(3).sum();
    };
    constexpr Eigen::Index linear = 3;
    constexpr std::size_t worth_second_order = 7;
    bounds.terms = fitted(linear);
    Rest rest = rest_of(bounds.terms);
    if (items.size() >= worth_second_order) {
        const Terms terms = fitted(term_count);
        const Rest less = rest_of(terms);
        if (size_of(less) < 0.5 * size_of(rest)) {
            bounds.terms = terms;
            rest = less;
        }
    }
    Coefficients& most = rest.most;
    // Rounding of A and of the sums here and in `children_exceeded`.
    const double rounding = 128 * std::numeric_limits<double>::epsilon() * rest.greatest_trace;
    for (int j = 0; j < 3; ++j) most[j] += rounding + 6 * uncertainty * rest.greatest[j];
    most[9] += rounding * rest.farthest + 6 * uncertainty * rest.greatest[9];
    // |x_j x_k| <= (x_j^2 + x_k^2) / 2: a tensor of the rows' sums is no less.
    const Vector sums(most[0] + most[3] + most[4], most[1] + most[3] + most[5],
                      most[2] + most[4] + most[5]);
    const Metric g = Metric::from_matrix(axes * sums.asDiagonal() * axes.transpose());
    bounds.rest = {g.xx, g.yy, g.zz, g.xy, g.xz, g.yz, most.segment<3>(6).matrix().norm(), most[9]};
    for (Eigen::Index k = 0; k < term_count; ++k) {
        const Coefficients q = bounds.terms.col(k);
        const Eigen::Matrix3d a =
            axes * Metric{q[0], q[1], q[2], q[3], q[4], q[5]}.matrix() * axes.transpose();
        const Vector b = axes * Vector(q[6], q[7], q[8]);
        bounds.terms.col(k) << a(0, 0), a(1, 1), a(2, 2), a(1, 0), a(2, 0), a(2, 1), b.array(),
            q[9];
    }
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

// Calls visit(0), ..., visit(n - 1) with constants, which vectors need.
template <std::size_t n, class Visit>
[[gnu::always_inline]] inline void unrolled(const Visit& visit) {
    [&]<std::size_t... i>(std::index_sequence<i...>) __attribute__((always_inline)) {
        (visit(std::integral_constant<std::size_t, i>()), ...);
    }
    (std::make_index_sequence<n>());
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
    const double squared_slope = h.slope * h.slope;
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
        const double counts = least > 0 ? squared_slope : 0;
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
ExceededChildren of_parallelograms(const QuadricNode& node, const Exceeding& h, double limit) {
    return exceeded_of<4>(node, h, limit);
}

CONTROLSPACE_VECTOR_CLONES
ExceededChildren of_patches(const QuadricNode& node, const Exceeding& h, double limit) {
    return exceeded_of<9>(node, h, limit);
}

void set(QuadricNode& node, std::size_t child, const Bounds& bounds) {
    for (int a = 0; a < 3; ++a) node.centre[static_cast<std::size_t>(a)][child] = bounds.centre[a];
    for (std::size_t k = 0; k < QuadricNode::term_count; ++k) {
        for (std::size_t j = 0; j < 10; ++j) {
            node.terms[k][j][child] =
                bounds.terms(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(k));
        }
    }
    for (std::size_t j = 0; j < 8; ++j) node.rest[j][child] = bounds.rest[j];
}

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

}  // namespace

Exceeding::Exceeding(const Point& place, const Eigen::Matrix3d& h, double slope_of_cones)
    : p(place), slope(slope_of_cones) {
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

QuadricTree::QuadricTree(std::span<ConeTreeItem> items, std::span<const PointSource> sources,
                         std::span<const double> lengths, double uncertainty)
    : vectors_(items.size() > 0 ? vectors_of_leaf * ((items.size() - 1) / leaf_size + 1) : 0) {
    std::vector<Metric> inverse_squares(sources.size());
    tbb::parallel_for(std::size_t{0}, items.size(), [&](std::size_t i) {
        const std::uint32_t source = items[i].index;
        inverse_squares[source] = square(inverse(sources[source].metric));
    });
    constexpr std::size_t arity = lane_count;
    const std::size_t leaf_count = vectors_.size() / vectors_of_leaf;
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
            set(nodes_[first + i / arity], i % arity,
                bounds_of(items_of<const ConeTreeItem>(leaves, items), inverse_squares,
                          uncertainty));
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
    tbb::parallel_for(std::size_t{0}, vectors_.size(), [&](std::size_t v) {
        const std::size_t begin = std::min(lane_count * v, items.size());
        const std::size_t end = std::min(begin + lane_count, items.size());
        if (begin < end) {
            vectors_[v] = tensor_leaf(items.subspan(begin, end - begin), sources, lengths);
        } else {
            vectors_[v].length.setConstant(std::numeric_limits<double>::infinity());
        }
    });
    indices_.resize(items.size());
    std::transform(items.begin(), items.end(), indices_.begin(),
                   [](const ConeTreeItem& item) { return item.index; });
}

std::size_t QuadricTree::bytes() const {
    return vectors_.capacity() * sizeof(TensorLeaf) + nodes_.capacity() * sizeof(QuadricNode) +
           (parents_.capacity() + indices_.capacity()) * sizeof(std::uint32_t);
}

}  // namespace controlspace
