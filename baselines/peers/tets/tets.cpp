// SPDX-License-Identifier: Apache-2.0
#include "baselines/peers/tets/background_tets.h"
#include "controlspace/space/catalogue.h"
#include "space/shared_builder.h"

namespace controlspace {

namespace {

template <TetBlend blend>
CatalogueEntry row(const char* id, const std::string& what) {
    return {.id = id,
            .description =
                "background mesh: Delaunay tetrahedra of the sources and the box's "
                "corners (CGAL), " +
                what + " linear in each; with schedule queue graded along its edges",
            .order = 1,
            .construct = [](const SpaceOptions& options) -> std::unique_ptr<ControlSpaceBuilder> {
                return std::make_unique<SharedBuilder<BackgroundTets>>(options, blend);
            },
            .capabilities = {MetricNodes{.rounding = blend == TetBlend::metrics ? 1e-12 : 1e-9}}};
}

}  // namespace

std::vector<CatalogueEntry> tets_rows() {
    return {row<TetBlend::metrics>("tets-linear", "M"),
            row<TetBlend::logarithms>("tets-log", "log M")};
}

}  // namespace controlspace
