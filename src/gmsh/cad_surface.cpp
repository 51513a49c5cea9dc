// SPDX-License-Identifier: Apache-2.0
#include "gmsh/cad_surface.h"

#include <gmsh.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "controlspace/geometry/box.h"
#include "gmsh/gmsh_mesh.h"
#include "gmsh/gmsh_session.h"
#include "refuse.h"

namespace controlspace {
namespace {

constexpr int surface = 2;

Vector vector_at(const std::vector<double>& numbers, std::size_t i) {
    return {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
}

/// From the first and second derivatives of a parametrisation; none where that is degenerate.
/// (Gmsh's own getPrincipalCurvatures gives no directions at poles, and does not say so.)
std::optional<Curvature> curvature_of(const Vector& along_u, const Vector& along_v,
                                      const Vector& uu, const Vector& vv, const Vector& uv) {
    constexpr double least_angle = 1e-6;
    const Vector normal = along_u.cross(along_v);
    const double area = normal.norm();
    if (!(area > least_angle * along_u.norm() * along_v.norm())) return std::nullopt;
    const Vector n = normal / area;
    // Both parameters are scaled, since their units may differ by far.
    const double u = 1 / along_u.norm(), v = 1 / along_v.norm();
    const double cosine = u * v * along_u.dot(along_v);
    Eigen::Matrix2d first, second;
    first << 1, cosine, cosine, 1;
    second << u * u * uu.dot(n), u * v * uv.dot(n), u * v * uv.dot(n), v * v * vv.dot(n);
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix2d> solver(second, first);
    const Eigen::Vector2d values = solver.eigenvalues().cwiseAbs();
    if (!values.allFinite()) return std::nullopt;
    const int larger = values[0] > values[1] ? 0 : 1;
    const Eigen::Vector2d direction = solver.eigenvectors().col(larger);
    Curvature result{.along = {values[larger], values[1 - larger]}, .frame = {}};
    result.frame.col(0) = (direction[0] * u * along_u + direction[1] * v * along_v).normalized();
    result.frame.col(1) = n.cross(result.frame.col(0));
    result.frame.col(2) = n;
    return result;
}

/// The nodes of one surface of the model, and where they are on it.
class Face {
public:
    explicit Face(int tag) : tag_(tag) {
        gmsh::model::mesh::getNodes(nodes_, places_, parameters_, surface, tag, true, true);
        parameters_.resize(2 * nodes_.size());
        gmsh::model::getParametrizationBounds(surface, tag, low_, high_);
    }

    const std::vector<std::size_t>& nodes() const { return nodes_; }

    /// For each node; none where its parameters on this face cannot be found, or a tangent there.
    std::vector<std::optional<Curvature>> curvatures(const SurfaceMesh& mesh) {
        constexpr double sewing = 1e-4;  // edges of files lie beside their faces by tolerances
        project_unless_within(rounding(mesh));
        move_from_poles(mesh.diagonal);
        std::vector<double> first, second;
        gmsh::model::getDerivative(surface, tag_, parameters_, first);
        gmsh::model::getSecondDerivative(surface, tag_, parameters_, second);
        const std::vector<double> distances = distances_to_nodes();
        std::vector<std::optional<Curvature>> result(nodes_.size());
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            if (!(distances[i] <= sewing * mesh.diagonal)) continue;
            result[i] = curvature_of(vector_at(first, 2 * i), vector_at(first, 2 * i + 1),
                                     vector_at(second, 3 * i), vector_at(second, 3 * i + 1),
                                     vector_at(second, 3 * i + 2));
        }
        return result;
    }

private:
    std::vector<double> distances_to_nodes() const {
        std::vector<double> there, distances;
        gmsh::model::getValue(surface, tag_, parameters_, there);
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            distances.push_back((vector_at(there, i) - vector_at(places_, i)).norm());
        }
        return distances;
    }

    void project_unless_within(double distance) {
        const std::vector<double> distances = distances_to_nodes();
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            if (distances[i] <= distance) continue;
            const Vector place = vector_at(places_, i);
            std::vector<double> found;
            gmsh::model::getParametrization(surface, tag_, {place.x(), place.y(), place.z()},
                                            found);
            if (found.size() == 2) std::copy(found.begin(), found.end(), &parameters_[2 * i]);
        }
    }

    /// At a sphere's poles and a cone's apex one of the parameters moves nothing, and derivatives
    /// say nothing: those a little beside stand for them.
    void move_from_poles(double diagonal) {
        constexpr double least = 1e-6, beside = 2e-5;
        std::vector<double> first;
        gmsh::model::getDerivative(surface, tag_, parameters_, first);
        for (std::size_t i = 0; i < parameters_.size(); ++i) {
            const double reach = vector_at(first, i).norm() * (high_[i % 2] - low_[i % 2]);
            if (reach > least * diagonal) continue;
            const std::size_t other = i ^ 1U;
            const double middle = (low_[other % 2] + high_[other % 2]) / 2;
            parameters_[other] += beside * (middle - parameters_[other]);
        }
    }

    int tag_;
    std::vector<std::size_t> nodes_;
    std::vector<double> places_, parameters_, low_, high_;
};

/// Adds the triangles of a surface, with the curvatures at their corners.
void add_face(int tag, const GmshNodes& nodes, SurfaceMesh& mesh) {
    Face face(tag);
    const auto found = face.curvatures(mesh);
    std::vector<std::uint32_t> number_of(nodes.places().size(), SurfaceMesh::unknown);
    for (std::size_t i = 0; i < found.size(); ++i) {
        if (!found[i]) continue;
        number_of[nodes.number(face.nodes()[i])] =
            static_cast<std::uint32_t>(mesh.curvatures.size());
        mesh.curvatures.push_back(*found[i]);
    }
    for (const auto& [a, b, c] : nodes.elements<3>(GmshNodes::triangle, tag)) {
        mesh.triangles.push_back({a, b, c});
        mesh.curvature_of.push_back({number_of[a], number_of[b], number_of[c]});
    }
}

Box model_box() {
    Box box;
    Point &low = box.low, &high = box.high;
    gmsh::model::getBoundingBox(-1, -1, low[0], low[1], low[2], high[0], high[1], high[2]);
    return box;
}

/// In a session of Gmsh; what goes wrong names the file.
void with_shapes(const std::filesystem::path& path, const std::function<void()>& action) {
    if (!std::filesystem::is_regular_file(path)) refuse_at(path, "no such file");
    try {
        in_gmsh_session(1, [&] {
            import_shapes(path);
            gmsh::model::occ::synchronize();
            action();
        });
    } catch (const InputError& error) {
        refuse_at(path, "{}", error.what());
    }
}

SurfaceMesh mesh_of_shapes() {
    constexpr double triangles_around = 36;
    SurfaceMesh mesh;
    gmsh::option::setNumber("Mesh.MeshSizeFromCurvature", triangles_around);
    gmsh::option::setNumber("Mesh.MeshSizeFromPoints", 0);
    // Towards the apex of a cone triangles would have no end.
    constexpr double smallest = 1e-4;
    gmsh::option::setNumber("Mesh.MeshSizeMin", smallest * model_box().edges().norm());
    gmsh::model::mesh::generate(surface);
    const GmshNodes nodes;
    mesh.vertices = nodes.places();
    if (!mesh.vertices.empty()) mesh.diagonal = bounding_box(mesh.vertices, 0).edges().norm();
    std::vector<std::pair<int, int>> faces;
    gmsh::model::getEntities(faces, surface);
    for (const auto& [dimension, tag] : faces) add_face(tag, nodes, mesh);
    return mesh;
}

}  // namespace

SurfaceMesh read_cad_surface(const std::filesystem::path& path) {
    SurfaceMesh mesh;
    with_shapes(path, [&] { mesh = mesh_of_shapes(); });
    if (mesh.triangles.empty()) refuse("{} has no surfaces: export a solid", path.string());
    return mesh;
}

Box cad_box(const std::filesystem::path& path) {
    Box box;
    with_shapes(path, [&] { box = model_box(); });
    return box;
}

}  // namespace controlspace
