// The grids of `openvdb-vec3s`, two of vectors of floats, as NanoVDB: one block of memory each,
// which is only read; what renderers and GPUs take.
#include <nanovdb/NanoVDB.h>

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "baselines/lattice/grid_row.h"
#include "baselines/lattice/grid_space.h"
#include "baselines/openvdb/vec3s_value.h"
#include "baselines/peers/nanovdb/dense_grid.h"

namespace controlspace {

namespace {

using Grid = nanovdb::NanoGrid<nanovdb::Vec3f>;
using Leaf = nanovdb::NanoLeaf<nanovdb::Vec3f>;

nanovdb::Coord coord(const Cell& cell) { return {cell[0], cell[1], cell[2]}; }

class NanoPair {
public:
    static constexpr bool shares_field = false;

    explicit NanoPair(const std::shared_ptr<const LatticeData>& data)
        : grids_(data->lattice(), data->field()) {}

    static double bytes_for(const Vector& nodes) { return 2 * dense_vec3s_bytes(nodes); }
    static Metric stored(const Metric& m) { return in_floats(m); }

    /// Two accessors of one thread. A cell's corners lie in one leaf as a rule.
    class Reader {
    public:
        using Leaves = std::pair<const Leaf*, const Leaf*>;
        template <std::size_t corners>
        using Values = std::array<const nanovdb::Vec3f*, corners>;

        explicit Reader(const NanoPair& pair)
            : diagonals_(pair.grids_.diagonals.grid<nanovdb::Vec3f>()->getAccessor()),
              off_diagonals_(pair.grids_.off_diagonals.grid<nanovdb::Vec3f>()->getAccessor()) {}

        Metric operator()(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
            const nanovdb::Coord ijk(static_cast<int>(i), static_cast<int>(j), static_cast<int>(k));
            return metric_of(diagonals_.getValue(ijk), off_diagonals_.getValue(ijk));
        }
        Leaves prepare(const Cell& cell) const {
            return {diagonals_.probeLeaf(coord(cell)), off_diagonals_.probeLeaf(coord(cell))};
        }
        template <std::size_t corners>
        auto find(const Cell& cell, const Leaves& leaves) const {
            return std::pair(values<corners>(diagonals_, cell, leaves.first),
                             values<corners>(off_diagonals_, cell, leaves.second));
        }
        Metric metric(const auto& at, std::size_t corner) const {
            return metric_of(*at.first[corner], *at.second[corner]);
        }

    private:
        using Accessor = Grid::AccessorType;
        template <std::size_t corners>
        static Values<corners> values(const Accessor& accessor, const Cell& cell,
                                      const Leaf* leaf) {
            constexpr auto side = static_cast<int>(Leaf::DIM);
            Values<corners> found;
            for (std::size_t corner = 0; corner < corners; ++corner) {
                const auto bits = static_cast<int>(corner);
                const nanovdb::Coord ijk(cell[0] + (bits & 1), cell[1] + (bits >> 1 & 1),
                                         cell[2] + (bits >> 2));
                if (((ijk[0] ^ cell[0]) | (ijk[1] ^ cell[1]) | (ijk[2] ^ cell[2])) >= side) {
                    const Leaf* beside = accessor.probeLeaf(ijk);
                    // Beyond the last node, where its weight is 0.
                    found[corner] = beside == nullptr ? found[0] : value(*beside, ijk);
                } else {
                    found[corner] = value(*leaf, ijk);
                }
                prefetch(found[corner]);
            }
            return found;
        }
        static const nanovdb::Vec3f* value(const Leaf& leaf, const nanovdb::Coord& ijk) {
            return &leaf.data()->mValues[Leaf::CoordToOffset(ijk)];
        }

        Accessor diagonals_, off_diagonals_;
    };
    Reader reader() const { return Reader(*this); }

    void add_to(Footprint& footprint) const {
        for (const NanoHandle* handle : {&grids_.diagonals, &grids_.off_diagonals}) {
            const std::size_t payload = handle->grid<nanovdb::Vec3f>()->tree().nodeCount(0) *
                                        sizeof(Leaf::DataType::mValues);
            footprint.bytes_payload += payload;
            footprint.bytes_topology += handle->size() - payload;
        }
    }

private:
    DenseNanoGrids grids_;
};

std::unique_ptr<ControlSpaceBuilder> make(const SpaceOptions& options,
                                          Interpolation interpolation) {
    return make_grid<NanoPair>(options, interpolation);
}

template <Interpolation interpolation>
CatalogueEntry row(std::string id, std::string description) {
    CatalogueEntry row = grid_row<make, interpolation>(std::move(id), std::move(description));
    row.capabilities = {MetricNodes{.rounding = 1e-6}, VoxelSize()};
    return row;
}

}  // namespace

std::vector<CatalogueEntry> nanovdb_rows() {
    return {
        row<Interpolation::nearest>("nanovdb-nearest",
                                    "two of NanoVDB's Vec3f grids, dense, six floats a voxel, "
                                    "also of lengths; constant"),
        row<Interpolation::trilinear>("nanovdb-trilinear",
                                      "two of NanoVDB's Vec3f grids, dense, six floats a voxel, "
                                      "also of lengths; trilinear")};
}

}  // namespace controlspace
