#include "baselines/openvdb/level_cells.h"

#include <fmt/format.h>

#include <algorithm>

#include "baselines/lattice/voxels.h"
#include "controlspace/error.h"
#include "controlspace/geometry/extent.h"

namespace controlspace {

namespace {

Vector finest_cells(const Box& domain, const Vector& coarsest_cells, int levels) {
    Vector cells = coarsest_cells * static_cast<double>(1 << (levels - 1));
    if (const auto flat = flat_axis(domain)) cells[*flat] = 1;
    return cells;
}

}  // namespace

LevelCells::LevelCells(const Box& domain, const Vector& coarsest_cells, int levels)
    : CellsOfBox(domain, finest_cells(domain, coarsest_cells, levels)),
      levels_(levels),
      spacing_(domain.edges().cwiseQuotient(cells())) {}

LevelCells::Coord LevelCells::cells_of(int level) const {
    const auto along = [&](Axis a) {
        return std::max(static_cast<openvdb::Int32>(cells()[a]) >> level, 1);
    };
    return {along(0), along(1), along(2)};
}

Point LevelCells::vertex(int level, const Coord& c) const {
    const Coord finest = c << static_cast<std::size_t>(level);
    return domain().low + spacing_.cwiseProduct(Vector(finest.x(), finest.y(), finest.z()));
}

Box LevelCells::box(int level, const Coord& c, const Point& x) const {
    return widened({vertex(level, c), vertex(level, c.offsetBy(1))}, x);
}

bool LevelCells::contains(int level, const Coord& c) const {
    return openvdb::CoordBBox({}, cells_of(level).offsetBy(-1)).isInside(c);
}

LevelCells choose_levels(const SpaceOptions& options) {
    require_valid(options);
    const double edge =
        finest_voxel(options) *
        (options.voxel > 0 ? 1 : std::min(1.0, options.voxel_factor / options.l_min));
    const Vector edges = options.domain.edges();
    constexpr double most = 1 << 29;
    if (!(edges.maxCoeff() / edge <= most)) {
        throw InputError(fmt::format(
            "a grid in levels cannot have voxels of {:.3g} on an edge of {:.3g}, more than 2^29: "
            "raise voxel",
            edge, edges.maxCoeff()));
    }
    constexpr double fewest = 8;
    int levels = 1;
    while (edges.maxCoeff() >= 2 * fewest * edge * (1 << (levels - 1))) ++levels;
    return {options.domain, whole_cells(edges / (edge * (1 << (levels - 1)))), levels};
}

}  // namespace controlspace
