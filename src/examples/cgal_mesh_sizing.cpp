// SPDX-License-Identifier: Apache-2.0
// A ball meshed by CGAL's Mesh_3, with a control space as its sizing field.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/make_mesh_3.h>
#include <controlspace/mesh/cgal_sizing.h>
#include <controlspace/mesh/conformity.h>
#include <controlspace/space/make_control_space.h>

#include <cstdio>
#include <map>
#include <vector>

using namespace controlspace;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Domain = CGAL::Labeled_mesh_domain_3<Kernel>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;

namespace {

TetMesh tetrahedra_of(const Complex& complex) {
    TetMesh mesh;
    std::map<Triangulation::Vertex_handle, VertexIndex> numbers;
    const auto number = [&](Triangulation::Vertex_handle v) {
        const auto [place, is_new] =
            numbers.emplace(v, static_cast<VertexIndex>(mesh.vertices.size()));
        const auto& p = v->point();
        if (is_new) mesh.vertices.emplace_back(p.x(), p.y(), p.z());
        return place->second;
    };
    for (auto cell = complex.cells_in_complex_begin(); cell != complex.cells_in_complex_end();
         ++cell) {
        Tetrahedron& tet = mesh.tets.emplace_back();
        for (int k = 0; k < 4; ++k) tet[static_cast<std::size_t>(k)] = number(cell->vertex(k));
    }
    return mesh;
}

}  // namespace

// An exception may end it, with its message.
int main() {  // NOLINT(bugprone-exception-escape)
    const std::vector<PointSource> sources{{Point(0.6, 0, 0), Metric::isotropic(0.04)},
                                           {Point(-1, 0, 0), Metric::isotropic(0.15)}};
    const auto field = make_control_space(
        "K_oV", sources, {.domain = {Point::Constant(-1.1), Point::Constant(1.1)}, .ratio = 1.2},
        0.05);

    namespace p = CGAL::parameters;
    const Domain ball = Domain::create_implicit_mesh_domain(
        [](const Kernel::Point_3& x) { return x.x() * x.x() + x.y() * x.y() + x.z() * x.z() - 1; },
        Kernel::Sphere_3(CGAL::ORIGIN, 1.2));
    const Criteria criteria(p::facet_angle = 25, p::cell_radius_edge_ratio = 2,
                            p::facet_distance = 0.01,
                            p::facet_size = CgalSizing(*field, CgalSizing::facets),
                            p::cell_size = CgalSizing(*field, CgalSizing::cells));
    const auto complex = CGAL::make_mesh_3<Complex>(ball, criteria, p::no_perturb(), p::no_exude());

    const TetMesh mesh = tetrahedra_of(complex);
    const Conformity found = conformity(mesh, *field);
    std::printf("%zu tetrahedra, edges %.2f times as long as requested, %.0f %% of them conform\n",
                mesh.tets.size(), found.mean_length, 100 * found.l_r);
}
