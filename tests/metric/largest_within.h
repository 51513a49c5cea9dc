// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "controlspace/metric/order_free_intersection.h"

// Order-free intersections in extended precision, by other formulas than the library's.

namespace controlspace {

using LongMatrix = Eigen::Matrix<long double, 3, 3>;
using LongSolver = Eigen::SelfAdjointEigenSolver<LongMatrix>;

inline LongMatrix long_matrix(const Metric& m) { return m.matrix().cast<long double>(); }
inline LongMatrix long_square(const Metric& m) { return long_matrix(m) * long_matrix(m); }

/// log det M^2 of the answer.
inline double log_det_square(const OrderFreeIntersection& answer) {
    return 2 * std::log(std::abs(answer.factor.determinant()));
}

/// Largest factor by which the answer's H H^T exceeds an M_k^2.
inline double excess(const OrderFreeIntersection& answer, std::span<const Metric> metrics) {
    long double most = 0;
    for (const Metric& m : metrics) {
        const LongMatrix k = long_matrix(m).inverse() * answer.factor.cast<long double>();
        most = std::max(most, LongSolver(k.transpose() * k).eigenvalues()[2]);
    }
    return static_cast<double>(most);
}

/// The duality gap that the multipliers prove. Their eigenvalues below 1e-12, which rounding may
/// have made, count as 0: less multipliers make the proof weaker, never wrong.
inline double proven_gap(const OrderFreeIntersection& answer, std::span<const Metric> metrics) {
    const LongMatrix inverse = answer.factor.cast<long double>().inverse();
    LongMatrix sum = LongMatrix::Zero();
    long double bound = -3;
    for (const auto& [index, tensor] : answer.multipliers()) {
        const LongMatrix half = inverse * long_matrix(metrics[index]);
        const LongSolver solver(long_matrix(tensor));
        for (int i = 0; i < 3; ++i) {
            const long double weight = solver.eigenvalues()[i];
            if (weight < 1e-12L) continue;
            const auto v = solver.eigenvectors().col(i);
            sum += weight * v * v.transpose();
            bound += weight * (half.transpose() * v).squaredNorm();
        }
    }
    return static_cast<double>(bound - std::log(sum.determinant()));
}

/// Largest Y within all M_k^2, by a primal barrier method: minimises
/// -log det Y - mu sum log det(M_k^2 - Y) for mu = 1, 1/4, ... by Newton's method with line search,
/// in a basis of the six-dimensional space, without any scaling. Slow, and for anisotropies up to
/// some hundreds.
class LargestWithin {
public:
    explicit LargestWithin(std::span<const Metric> metrics) {
        LongMatrix inverses = LongMatrix::Zero();
        for (const Metric& m : metrics) {
            squares_.push_back(long_square(m));
            inverses += squares_.back().inverse();
        }
        y_ = inverses.inverse() / 2;
        for (mu_ = 1; mu_ > 1e-12L; mu_ /= 4) minimise();
    }
    const LongMatrix& square() const { return y_; }

private:
    // Infinite outside.
    long double barrier(const LongMatrix& y) const {
        long double value = -log_det(y);
        for (const LongMatrix& b : squares_) value -= mu_ * log_det(b - y);
        return value;
    }
    static long double log_det(const LongMatrix& m) {
        const Eigen::LLT<LongMatrix> factor(m);
        if (factor.info() != Eigen::Success) return -INFINITY;
        return 2 * factor.matrixLLT().diagonal().array().log().sum();
    }
    static LongMatrix basis(int e) {
        const int rows[] = {0, 1, 2, 0, 0, 1};
        const int columns[] = {0, 1, 2, 1, 2, 2};
        LongMatrix m = LongMatrix::Zero();
        m(rows[e], columns[e]) = m(columns[e], rows[e]) = 1;
        return m;
    }
    void minimise() {
        for (int step = 0; step < 100; ++step) {
            Eigen::Matrix<long double, 6, 1> gradient = Eigen::Matrix<long double, 6, 1>::Zero();
            Eigen::Matrix<long double, 6, 6> hessian = Eigen::Matrix<long double, 6, 6>::Zero();
            const auto add = [&](const LongMatrix& inverse, long double weight, int sign) {
                for (int i = 0; i < 6; ++i) {
                    const LongMatrix left = inverse * basis(i);
                    gradient[i] += sign * weight * left.trace();
                    for (int j = 0; j < 6; ++j) {
                        hessian(i, j) += weight * (left * inverse * basis(j)).trace();
                    }
                }
            };
            add(y_.inverse(), 1, -1);
            for (const LongMatrix& b : squares_) add((b - y_).inverse(), mu_, 1);
            const Eigen::Matrix<long double, 6, 1> step_taken = hessian.ldlt().solve(-gradient);
            const long double decrease = -gradient.dot(step_taken);
            if (decrease < 1e-17L) return;
            LongMatrix direction = LongMatrix::Zero();
            for (int i = 0; i < 6; ++i) direction += step_taken[i] * basis(i);
            const long double now = barrier(y_);
            long double length = 1;
            while (!(barrier(y_ + length * direction) <= now - 0.1L * length * decrease)) {
                length /= 2;
                if (length < 1e-10L) return;  // rounding is all that is left
            }
            y_ += length * direction;
        }
    }

    std::vector<LongMatrix> squares_;
    LongMatrix y_;
    long double mu_ = 1;
};

}  // namespace controlspace
