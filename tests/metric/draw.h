// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>

#include "controlspace/metric/metric.h"
#include "metric/decompose.h"

namespace controlspace {

/// Random metrics, rotations and directions; the same for the same seed.
class Draw {
public:
    explicit Draw(unsigned seed) : engine_(seed) {}

    double uniform(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(engine_);
    }
    Vector vector() {
        std::normal_distribution<double> normal;
        const double x = normal(engine_);
        const double y = normal(engine_);
        return {x, y, normal(engine_)};
    }
    Eigen::Matrix3d rotation() {
        Eigen::Quaterniond q;
        q.coeffs().head<3>() = vector();
        q.coeffs()[3] = vector()[0];
        return q.normalized().toRotationMatrix();
    }
    /// Lengths around `size`, the largest `anisotropy` times the smallest.
    std::array<double, 3> lengths(double size, double anisotropy) {
        const double half = std::sqrt(anisotropy);
        return {size / half, size * half, size * half * std::pow(anisotropy, -uniform(0, 1))};
    }
    Metric metric(double size, double anisotropy) {
        return metric_from_frame(lengths(size, anisotropy), rotation());
    }

private:
    std::mt19937 engine_;
};

/// R M R^T.
inline Metric rotated(const Metric& m, const Eigen::Matrix3d& r) {
    return Metric::from_matrix(r * m.matrix() * r.transpose());
}

/// Largest difference of an entry, relative to the largest entry of `b`.
inline double difference(const Metric& a, const Metric& b) {
    return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff() / b.matrix().cwiseAbs().maxCoeff();
}

/// Largest relative difference of the lengths that `a` and `b` give to any one direction: how far
/// the singular values of a^-1 b are from 1. Taken in extended precision.
inline double length_difference(const Metric& a, const Metric& b) {
    using Matrix = Eigen::Matrix<long double, 3, 3>;
    const Matrix c = a.matrix().cast<long double>().inverse() * b.matrix().cast<long double>();
    const auto squares =
        Eigen::SelfAdjointEigenSolver<Matrix>(c * c.transpose(), Eigen::EigenvaluesOnly)
            .eigenvalues();
    return static_cast<double>(
        std::max(std::abs(std::sqrt(squares[0]) - 1), std::abs(std::sqrt(squares[2]) - 1)));
}

}  // namespace controlspace
