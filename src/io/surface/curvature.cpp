// SPDX-License-Identifier: Apache-2.0
#include "io/surface/curvature.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace controlspace {
namespace {

// z = p x + q y + (a x^2 + 2 b x y + c y^2) / 2 and terms of third order, which vertices at the
// boundary of a patch do not determine.
using Row = Eigen::Matrix<double, 9, 1>;
constexpr int up_to_second = 5, up_to_third = 9;

Row height_row(double x, double y) {
    return (Row() << x, y, x * x / 2, x * y, y * y / 2, x * x * x, x * x * y, x * y * y, y * y * y)
        .finished();
}
Row slope_x_row(double x, double y) {
    return (Row() << 1, 0, x, y, 0, 3 * x * x, 2 * x * y, y * y, 0).finished();
}
Row slope_y_row(double x, double y) {
    return (Row() << 0, 1, 0, x, y, 0, x * x, 2 * x * y, 3 * y * y).finished();
}

/// Normal equations.
struct Equations {
    Eigen::Matrix<double, 9, 9> matrix = Eigen::Matrix<double, 9, 9>::Zero();
    Row right = Row::Zero();

    void add(const Row& row, double value, double weight) {
        matrix += weight * row * row.transpose();
        right += weight * value * row;
    }

    /// The first `terms` coefficients; as small as possible where the rows do not determine them.
    Row solve(int terms) const {
        constexpr double tiny = 1e-30, ridge = 1e-9, ridge_of_third = 1e-2;
        Row scale = matrix.diagonal().cwiseMax(tiny).cwiseSqrt().cwiseInverse();
        Eigen::Matrix<double, 9, 9> scaled = scale.asDiagonal() * matrix * scale.asDiagonal();
        scaled.diagonal().array() += ridge;
        scaled.diagonal().tail(up_to_third - up_to_second).array() += ridge_of_third;
        Row solution = Row::Zero();
        solution.head(terms) =
            scaled.topLeftCorner(terms, terms).ldlt().solve(right.cwiseProduct(scale).head(terms));
        return solution.cwiseProduct(scale);
    }
};

/// Fans of the same patch in two rings around one, except those that face away in the second.
std::vector<std::uint32_t> fans_around(const SmoothPatches& patches, const Fan& centre) {
    constexpr double facing = 0.5;
    std::vector<std::uint32_t> found;
    const auto add_ring = [&](const Fan& fan, double least) {
        for (const std::uint32_t t : fan.triangles) {
            std::ranges::copy_if(patches.fan_of[t], std::back_inserter(found), [&](auto i) {
                const Fan& other = patches.fans[i];
                return other.vertex != centre.vertex &&
                       (other.apex || other.normal.dot(centre.normal) >= least);
            });
        }
    };
    const auto keep_one_each = [&] {
        std::sort(found.begin(), found.end());
        found.erase(std::unique(found.begin(), found.end()), found.end());
    };
    add_ring(centre, -2);
    keep_one_each();
    const std::vector<std::uint32_t> first_ring = found;
    for (const std::uint32_t i : first_ring) {
        if (!patches.fans[i].apex) add_ring(patches.fans[i], facing);
    }
    keep_one_each();
    return found;
}

Eigen::Matrix3d frame_around(const Vector& normal) {
    Eigen::Matrix3d frame;
    frame.col(0) = normal.unitOrthogonal();
    frame.col(1) = normal.cross(frame.col(0));
    frame.col(2) = normal;
    return frame;
}

class Fit {
public:
    Fit(const SurfaceMesh& mesh, const SmoothPatches& patches, const Fan& centre)
        : mesh_(mesh), patches_(patches), centre_(centre), around_(fans_around(patches, centre)) {
        // The third shortest distance: a vertex that is very near must not outweigh all others.
        constexpr std::size_t third = 2;
        std::vector<double> distances;
        distances.reserve(around_.size());
        for (const std::uint32_t i : around_) distances.push_back(offset(patches.fans[i]).norm());
        const auto nth =
            distances.begin() + static_cast<std::ptrdiff_t>(std::min(third, distances.size() - 1));
        std::nth_element(distances.begin(), nth, distances.end());
        scale_ = *nth;
    }

    Curvature curvature() const {
        constexpr int passes = 3;
        Eigen::Matrix3d frame = frame_around(centre_.normal);
        Row x;
        for (int pass = 0;; ++pass) {
            x = equations(frame).solve(centre_.closed ? up_to_third : up_to_second);
            if (pass + 1 == passes) break;
            frame = frame_around((frame * Vector(-x[0], -x[1], 1)).normalized());
        }
        return principal((Eigen::Matrix2d() << x[2], x[3], x[3], x[4]).finished() / scale_, frame);
    }

private:
    Vector offset(const Fan& fan) const {
        return mesh_.vertices[fan.vertex] - mesh_.vertices[centre_.vertex];
    }

    Equations equations(const Eigen::Matrix3d& frame) const {
        Equations equations;
        add_normal(equations, frame, centre_, 0, 0, 1);
        for (const std::uint32_t i : around_) {
            const Fan& fan = patches_.fans[i];
            const Vector d = frame.transpose() * offset(fan) / scale_;
            const double distance = d.norm(), chord = distance / std::max(d.head(2).norm(), 1e-9);
            const double x = chord * d.x(), y = chord * d.y();
            const double weight = 1 / std::pow(std::max(distance, 1.0), 6);
            equations.add(height_row(x, y), d.z(), weight);
            if (!fan.apex) add_normal(equations, frame, fan, x, y, weight * distance * distance);
        }
        return equations;
    }

    static void add_normal(Equations& equations, const Eigen::Matrix3d& frame, const Fan& fan,
                           double x, double y, double weight) {
        constexpr double steepest = 0.5, share = 1e-3;
        const Vector n = frame.transpose() * fan.normal;
        if (n.z() < steepest) return;
        equations.add(slope_x_row(x, y), -n.x() / n.z(), share * weight);
        equations.add(slope_y_row(x, y), -n.y() / n.z(), share * weight);
    }

    static Curvature principal(const Eigen::Matrix2d& shape, const Eigen::Matrix3d& frame) {
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(shape);
        Curvature result{.frame = frame};
        const Eigen::Vector2d values = solver.eigenvalues().cwiseAbs();
        const int larger = values[0] > values[1] ? 0 : 1;
        for (const int k : {0, 1}) {
            const int from = k == 0 ? larger : 1 - larger;
            result.along[static_cast<std::size_t>(k)] = values[from];
            result.frame.col(k) = frame.leftCols(2) * solver.eigenvectors().col(from);
        }
        return result;
    }

    const SurfaceMesh& mesh_;
    const SmoothPatches& patches_;
    const Fan& centre_;
    std::vector<std::uint32_t> around_;
    double scale_ = 1;
};

bool is_flat(const SurfaceMesh& mesh, const Fan& fan) {
    const Point& centre = mesh.vertices[fan.vertex];
    return std::ranges::all_of(fan.triangles, [&](std::uint32_t t) {
        return std::ranges::all_of(mesh.triangles[t], [&](std::uint32_t v) {
            return std::abs(fan.normal.dot(mesh.vertices[v] - centre)) <= rounding(mesh);
        });
    });
}

}  // namespace

Curvature curvature_at(const SurfaceMesh& mesh, const SmoothPatches& patches, const Fan& fan) {
    if (fan.apex) {
        constexpr double infinity = std::numeric_limits<double>::infinity();
        return {.along = {infinity, infinity}, .frame = Eigen::Matrix3d::Identity()};
    }
    if (is_flat(mesh, fan)) return {.frame = frame_around(fan.normal)};
    return Fit(mesh, patches, fan).curvature();
}

}  // namespace controlspace
