// SPDX-License-Identifier: Apache-2.0
#include <gmsh.h>

#include <algorithm>

#include "baselines/peers/gmsh/gmsh_space.h"
#include "baselines/peers/tets/background_tets.h"
#include "controlspace/sources/riemannian.h"
#include "space/shared_builder.h"

namespace controlspace {

namespace {

/// The tetrahedra of `tets-linear` as a view of Gmsh behind its field PostView: of isotropic
/// metrics sizes, otherwise the Riemannian tensors that meshers expect; linear in these.
GmshSpace::Made made_view(const BackgroundTets& tets, bool has_tensors) {
    const int corners = tets.corners_of_cell();
    std::vector<double> data;
    int cells = 0;
    tets.for_each_cell([&](Delaunay::Cell_handle cell) {
        ++cells;
        for (int axis = 0; axis < 3; ++axis) {
            for (int i = 0; i < corners; ++i) {
                data.push_back(BackgroundTets::position(cell->vertex(i))[axis]);
            }
        }
        for (int i = 0; i < corners; ++i) {
            const Metric m = tets.metric(cell->vertex(i));
            if (has_tensors) {
                const Metric r = to_riemannian(m);
                data.insert(data.end(), {r.xx, r.xy, r.xz, r.xy, r.yy, r.yz, r.xz, r.yz, r.zz});
            } else {
                data.push_back(m.xx);
            }
        }
    });
    const std::string kind = std::string(has_tensors ? "T" : "S") + (corners == 4 ? "S" : "T");
    const int view = gmsh::view::add("sizes");
    gmsh::view::addListData(view, kind, cells, data);
    const int field = gmsh::model::mesh::field::add("PostView");
    gmsh::model::mesh::field::setNumber(field, "ViewTag", view);
    return {field, view, has_tensors};
}

struct ViewedTets : BackgroundTets {
    explicit ViewedTets(const SpaceOptions& options) : BackgroundTets(options, TetBlend::view) {}
    static std::unique_ptr<ControlSpace> finished(const std::shared_ptr<const ViewedTets>& tets,
                                                  std::optional<Precision> precision) {
        if (precision) refuse_precision();
        const bool has_tensors =
            !std::ranges::all_of(tets->mesh().finite_vertex_handles(),
                                 [&](auto vertex) { return is_isotropic(tets->metric(vertex)); });
        const Footprint of_tets = tets->footprint();
        Footprint counts;
        counts.cells = of_tets.cells;
        counts.control_nodes = of_tets.control_nodes;
        // Each tetrahedron holds its own copy of its vertices.
        const auto values =
            static_cast<std::size_t>(tets->corners_of_cell()) * (has_tensors ? 9 : 1);
        counts.bytes_payload = counts.cells * values * sizeof(double);
        return std::make_unique<GmshSpace>(tets->domain(), counts,
                                           [&] { return made_view(*tets, has_tensors); });
    }
};

}  // namespace

CatalogueEntry gmsh_view_row() {
    return {.id = "gmsh-view",
            .description =
                "the tetrahedra of tets-linear as a view of Gmsh, asked by its field "
                "PostView: sizes; of tensors M^-2, linear",
            .order = 1,
            .construct = [](const SpaceOptions& options) -> std::unique_ptr<ControlSpaceBuilder> {
                open_gmsh();
                return std::make_unique<SharedBuilder<ViewedTets>>(options);
            },
            .capabilities = {MetricNodes{.rounding = 1e-6}}};
}

}  // namespace controlspace
