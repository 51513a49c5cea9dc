// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "cones/quadric_node.h"
#include "controlspace/metric/metric.h"

namespace controlspace {
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
        if (!(frame.lengths[2] > 0)) return;
        const bool is_line = !(frame.lengths[1] > flat * frame.lengths[2]);
        // The smallest rectangle that holds all: covariance does not tell the sides of a square.
        constexpr int most_turns = 8;
        constexpr double right_angle = 1.5707963267948966;
        double least = std::numeric_limits<double>::infinity();
        for (int turn = 0; turn < (is_line ? 1 : most_turns); ++turn) {
            const double angle = right_angle / most_turns * turn;
            Eigen::Matrix<double, 3, 2> turned;
            turned.col(0) = std::cos(angle) * frame.directions.col(2) +
                            std::sin(angle) * frame.directions.col(1);
            turned.col(1) = std::cos(angle) * frame.directions.col(1) -
                            std::sin(angle) * frame.directions.col(2);
            Eigen::Vector2d low = Eigen::Vector2d::Zero();
            Eigen::Vector2d high = low;
            for (const ConeTreeItem& item : items) {
                const Eigen::Vector2d x = turned.transpose() * (item.position() - centre);
                low = low.cwiseMin(x);
                high = high.cwiseMax(x);
            }
            const double size = (high - low).squaredNorm();
            if (!(size < least)) continue;
            least = size;
            for (int k = 0; k < (is_line ? 1 : 2); ++k) {
                if (!(high[k] > low[k])) continue;
                directions_.col(k) = 2 / (high[k] - low[k]) * turned.col(k);
                offsets_[k] =
                    -(high[k] + low[k]) / (high[k] - low[k]) - directions_.col(k).dot(centre);
            }
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

}  // namespace

void set_child(QuadricNode& node, std::size_t child, std::span<const ConeTreeItem> items,
               std::span<const Metric> inverse_squares, double uncertainty) {
    const Bounds bounds = bounds_of(items, inverse_squares, uncertainty);
    for (int a = 0; a < 3; ++a) node.centre[static_cast<std::size_t>(a)][child] = bounds.centre[a];
    for (std::size_t k = 0; k < QuadricNode::term_count; ++k) {
        for (std::size_t j = 0; j < 10; ++j) {
            node.terms[k][j][child] =
                bounds.terms(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(k));
        }
    }
    for (std::size_t j = 0; j < 8; ++j) node.rest[j][child] = bounds.rest[j];
}

}  // namespace controlspace
