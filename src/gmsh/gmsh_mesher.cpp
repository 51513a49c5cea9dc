// SPDX-License-Identifier: Apache-2.0
#include "controlspace/gmsh/gmsh_mesher.h"

#include <gmsh.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "gmsh/gmsh_mesh.h"
#include "gmsh/gmsh_session.h"
#include "measure/stopwatch.h"
#include "mesh/estimate.h"
#include "mesh/size_query.h"
#include "refuse.h"

namespace controlspace {
namespace {

/// By tag, a third of the length of each curve that ends where it begins: Gmsh 4.8 crashes, or does
/// not end, on some of those that get fewer than three edges.
std::map<int, double> thirds_of_closed_curves() {
    constexpr int curve = 1, samples = 60;
    std::map<int, double> thirds;
    std::vector<std::pair<int, int>> curves, ends;
    gmsh::model::getEntities(curves, curve);
    for (const auto& [dimension, tag] : curves) {
        gmsh::model::getBoundary({{dimension, tag}}, ends, false, false);
        if (ends.size() == 2 && ends[0].second != ends[1].second) continue;
        std::vector<double> low, high, parameters, x;
        gmsh::model::getParametrizationBounds(curve, tag, low, high);
        for (int i = 0; i <= samples; ++i) {
            parameters.push_back(low.at(0) + (high.at(0) - low.at(0)) * i / samples);
        }
        gmsh::model::getValue(curve, tag, parameters, x);
        double length = 0;
        for (std::size_t i = 3; i + 2 < x.size(); i += 3) {
            length += std::hypot(x[i] - x[i - 3], x[i + 1] - x[i - 2], x[i + 2] - x[i - 1]);
        }
        if (length > 0) thirds[tag] = length / 3;
    }
    return thirds;
}

/// On curves and surfaces sizes are multiplied by `on_surfaces` besides.
void set_size_callback(SizeQuery& query, double on_surfaces) {
    const auto size = [&query, on_surfaces, thirds = thirds_of_closed_curves()](
                          int dimension, int tag, double x, double y, double z) {
        const double h = (dimension < 3 ? on_surfaces : 1) * query(x, y, z);
        const auto third = dimension == 1 ? thirds.find(tag) : thirds.end();
        return third == thirds.end() ? h : std::min(h, third->second);
    };
#if GMSH_API_VERSION_MAJOR > 4 || (GMSH_API_VERSION_MAJOR == 4 && GMSH_API_VERSION_MINOR >= 9)
    // From 4.9 on, what is returned takes the place of the other sizes.
    gmsh::model::mesh::setSizeCallback(
        [size](int dimension, int tag, double x, double y, double z, double other) {
            return std::min(other, size(dimension, tag, x, y, z));
        });
#else
    gmsh::model::mesh::setSizeCallback(size);
#endif
}

void add_box(const UnitFrame& frame) {
    const Vector edges = frame.edges();
    gmsh::model::occ::addBox(0, 0, 0, edges.x(), edges.y(), edges.z());
    gmsh::model::occ::synchronize();
}

using Entities = std::vector<std::pair<int, int>>;  ///< dimension and tag

using Corners = std::array<Point, 3>;

/// A connected piece of a surface without rims: the outside of a body, or a hole in one.
struct Shell {
    std::vector<int> patches;
    std::vector<Corners> triangles;

    /// Whether a ray from there crosses it an odd number of times.
    bool contains(const Point& p) const {
        const Vector direction(0.5139, 0.7373, 0.4385);  // along no edge of usual parts
        return std::ranges::count_if(triangles,
                                     [&](const Corners& t) {
                                         const Vector a = t[1] - t[0], b = t[2] - t[0];
                                         const Vector n = direction.cross(b), from = p - t[0];
                                         const double det = a.dot(n), u = from.dot(n) / det;
                                         const Vector q = from.cross(a);
                                         const double v = direction.dot(q) / det;
                                         return det != 0 && u >= 0 && v >= 0 && u + v <= 1 &&
                                                b.dot(q) / det > 0;
                                     }) %
                   2 !=
               0;
    }
};

/// Patches that share curves are of one shell.
std::vector<Shell> shells_of(const Entities& patches) {
    constexpr int surface = 2;
    const GmshNodes nodes;
    std::vector<Shell> shells;
    std::map<int, std::size_t> shell_of_curve;
    for (const auto& [dimension, tag] : patches) {
        Shell shell{.patches = {tag}, .triangles = {}};
        for (const auto& [a, b, c] : nodes.elements<3>(GmshNodes::triangle, tag)) {
            const auto& x = nodes.places();
            shell.triangles.push_back({x[a], x[b], x[c]});
        }
        std::vector<int> volumes, curves;
        gmsh::model::getAdjacencies(surface, tag, volumes, curves);
        const std::size_t number = shells.size();
        shells.push_back(std::move(shell));
        for (const int curve : curves) {
            const auto [known, is_new] = shell_of_curve.emplace(curve, number);
            const std::size_t other = known->second;
            if (is_new || other == number) continue;
            // All of the other one's are this one's now.
            for (auto& [any, s] : shell_of_curve) s = s == other ? number : s;
            std::ranges::move(shells[other].patches, std::back_inserter(shells[number].patches));
            std::ranges::move(shells[other].triangles,
                              std::back_inserter(shells[number].triangles));
            shells[other] = {};
        }
    }
    std::erase_if(shells, [](const Shell& shell) { return shell.triangles.empty(); });
    return shells;
}

/// A volume for each shell that is inside of an even number of others; the next ones inside of it
/// are its holes.
void add_bodies(const std::vector<Shell>& shells) {
    std::vector<std::vector<char>> inside(shells.size());  // of which others
    std::vector<std::ptrdiff_t> depth;
    for (std::size_t i = 0; i < shells.size(); ++i) {
        const auto& [a, b, c] = shells[i].triangles.front();
        for (const Shell& other : shells) {
            inside[i].push_back(&other != &shells[i] && other.contains((a + b + c) / 3));
        }
        depth.push_back(std::ranges::count(inside[i], 1));
    }
    for (std::size_t i = 0; i < shells.size(); ++i) {
        if (depth[i] % 2 != 0) continue;
        std::vector<int> loops{gmsh::model::geo::addSurfaceLoop(shells[i].patches)};
        for (std::size_t k = 0; k < shells.size(); ++k) {
            if (inside[k][i] == 0 || depth[k] != depth[i] + 1) continue;
            loops.push_back(gmsh::model::geo::addSurfaceLoop(shells[k].patches));
        }
        gmsh::model::geo::addVolume(loops);
    }
}

/// Bodies inside of triangles, which are cut into patches along creases.
void add_surface(const Part& part, const UnitFrame& frame) {
    constexpr int surface = 2, entity = 1, triangle = 2;
    std::vector<std::size_t> tags, corners;
    std::vector<double> coordinates;
    for (const Point& p : part.vertices) {
        const Point x = frame.from_domain(p);
        coordinates.insert(coordinates.end(), x.begin(), x.end());
        tags.push_back(tags.size() + 1);
    }
    for (const Triangle& t : part.triangles) {
        for (const VertexIndex v : t) corners.push_back(v + std::size_t{1});
    }
    gmsh::model::addDiscreteEntity(surface, entity);
    gmsh::model::mesh::addNodes(surface, entity, tags, coordinates);
    gmsh::model::mesh::addElementsByType(entity, triangle, {}, corners);
    constexpr double degree = std::numbers::pi / 180;
    gmsh::model::mesh::classifySurfaces(part.crease * degree, true, true, std::numbers::pi);
    gmsh::model::mesh::createGeometry();
    Entities patches;
    gmsh::model::getEntities(patches, surface);
    add_bodies(shells_of(patches));
    gmsh::model::geo::synchronize();
}

void add_cad(const Part& part, const UnitFrame& frame) {
    gmsh::option::setNumber("Geometry.OCCScaling", part.scale / frame.scale);
    const Entities shapes = import_shapes(part.cad);
    const Vector low = frame.domain.low / frame.scale;
    gmsh::model::occ::translate(shapes, -low.x(), -low.y(), -low.z());
    gmsh::model::occ::synchronize();
    Entities volumes;
    gmsh::model::getEntities(volumes, 3);
    if (volumes.empty()) refuse("{} holds no solid: export one", part.cad.string());
    if (volumes.size() > 1) {
        // Solids that touch get common faces, and one mesh.
        Entities pieces;
        std::vector<Entities> pieces_of;
        gmsh::model::occ::fragment(volumes, {}, pieces, pieces_of);
        gmsh::model::occ::synchronize();
    }
}

void require_inside(const UnitFrame& frame) {
    constexpr double tolerance = 1e-6;
    Vector low, high;
    gmsh::model::getBoundingBox(-1, -1, low[0], low[1], low[2], high[0], high[1], high[2]);
    const Vector edges = frame.edges();
    if ((low.array() >= -tolerance).all() && (high.array() <= edges.array() + tolerance).all()) {
        return;
    }
    const auto place = [&](const Vector& x) { return Point(frame.domain.low + frame.scale * x); };
    refuse(
        "the part {} is not inside of the field's domain {}: make a field with a larger --domain",
        to_string(Box{place(low), place(high)}), to_string(frame.domain));
}

void add_geometry(const Part* part, const UnitFrame& frame) {
    if (part == nullptr) return add_box(frame);
    part->cad.empty() ? add_surface(*part, frame) : add_cad(*part, frame);
    require_inside(frame);
}

void set_options(const GmshOptions& options) {
    const auto set = [](const char* name, double value) { gmsh::option::setNumber(name, value); };
    // Sizes come from the callback alone.
    set("Mesh.MeshSizeFromPoints", 0);
    set("Mesh.MeshSizeFromCurvature", 0);
    set("Mesh.MeshSizeExtendFromBoundary", 0);
    constexpr double delaunay = 1, hxt = 10;
    set("Mesh.Algorithm3D", options.algorithm == GmshAlgorithm::hxt ? hxt : delaunay);
}

void generate(GmshAlgorithm algorithm, double optimize) {
    constexpr const char* threshold = "Mesh.OptimizeThreshold";
    constexpr int volumes = 3;
    if (algorithm == GmshAlgorithm::delaunay) {
        gmsh::option::setNumber(threshold, optimize);
        gmsh::model::mesh::generate(volumes);
        return;
    }
    // HXT's own improvement does not end at high thresholds: it keeps its default, and Gmsh's
    // common one goes on from there.
    gmsh::model::mesh::generate(volumes);
    double reached = 0;
    gmsh::option::getNumber(threshold, reached);
    if (optimize <= reached) return;
    gmsh::option::setNumber(threshold, optimize);
    gmsh::model::mesh::optimize("");
}

TetMesh take_mesh(const UnitFrame& frame) {
    const GmshNodes nodes;
    TetMesh mesh;
    for (const Point& x : nodes.places()) {
        mesh.vertices.push_back(frame.to_domain(x.x(), x.y(), x.z()));
    }
    mesh.triangles = nodes.elements<3>(GmshNodes::triangle);
    mesh.tets = nodes.elements<4>(GmshNodes::tetrahedron);
    turn_upright(mesh);
    return mesh;
}

void require_valid(const Box& domain, const ControlSpace& field, const GmshOptions& options) {
    require_volume(domain);
    const double factor = options.factor.value_or(1);
    if (!std::isfinite(factor) || factor <= 0) {
        refuse("factor {} of sizes: give a positive one", factor);
    }
    const double optimize = options.optimize.value_or(0);
    if (!(optimize >= 0 && optimize < 1)) {
        refuse(
            "optimize {}: give a quality from 0 to below 1; 0.7 is good, "
            "from 0.8 on it takes long",
            optimize);
    }
    // Of a part the estimate, which is for the domain, would be too high.
    if (!options.part) require_few_tets(domain, field, options.max_tets);
}

}  // namespace

double standard_factor(GmshAlgorithm algorithm) {
    return algorithm == GmshAlgorithm::hxt ? 0.70 : 0.77;
}

double standard_optimize(GmshAlgorithm algorithm) {
    return algorithm == GmshAlgorithm::hxt ? 0.6 : 0.75;
}

MeshRun mesh_with_gmsh(const Box& domain, const ControlSpace& field, const GmshOptions& options) {
    require_valid(domain, field, options);
    const UnitFrame frame(domain);
    SizeQuery query(field, frame, options.factor.value_or(standard_factor(options.algorithm)));
    MeshRun run;
    in_gmsh_session(options.threads, [&] {
        if (options.reports) {
            constexpr double warnings_and_errors = 2;
            gmsh::option::setNumber("General.Terminal", 1);
            gmsh::option::setNumber("General.Verbosity", warnings_and_errors);
        }
        add_geometry(options.part.get(), frame);
        set_options(options);
        // Triangles are hardly larger than requested, and most edges of a thin part are on its
        // surface: L_R of the pipes of bench/day-one, by HXT, is 0.82, and 0.45 without this.
        constexpr double surface_factor = 0.95;
        set_size_callback(query,
                          options.part ? surface_factor / standard_factor(options.algorithm) : 1);
        const Stopwatch watch;
        try {
            generate(options.algorithm,
                     options.optimize.value_or(standard_optimize(options.algorithm)));
        } catch (...) {
            query.rethrow_failure();  // the cause, if it is ours
            throw;
        }
        run.cost.seconds = watch.seconds();
        run.cost.processor_seconds = watch.processor_seconds();
        query.rethrow_failure();
        run.cost.queries = query.count();
        run.cost.query_seconds = query.seconds();
        run.anisotropic = query.anisotropic();
        run.mesh = take_mesh(frame);
        if (run.mesh.tets.empty()) {
            std::string why;
            gmsh::logger::getLastError(why);
            refuse("Gmsh made no tetrahedra{}{}: {}try the other algorithm",
                   why.empty() ? "" : ": ", why,
                   options.part ? "check that the part is closed, or " : "");
        }
    });
    return run;
}

}  // namespace controlspace
