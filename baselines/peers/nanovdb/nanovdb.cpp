// SPDX-License-Identifier: Apache-2.0
// Dense grids of NanoVDB, in one block of memory each, which is only read; what renderers and GPUs
// take: one of floats where a length is enough, two of vectors of floats, as those of
// `openvdb-vec3s`, where metrics are needed.
#include <nanovdb/NanoVDB.h>

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "baselines/lattice/grid_row.h"
#include "baselines/lattice/grid_space.h"
#include "baselines/openvdb/vec3s_value.h"
#include "baselines/peers/nanovdb/dense_grid.h"
#include "baselines/peers/nanovdb/nano_tiles.h"

namespace controlspace {

namespace {

nanovdb::Coord coord(const Cell& cell) { return {cell[0], cell[1], cell[2]}; }

/// Reads the values of one grid, for one thread. A cell's corners lie in one leaf as a rule.
template <class T>
class NanoReader {
public:
    using Leaf = nanovdb::NanoLeaf<T>;
    template <std::size_t corners>
    using Values = std::array<const T*, corners>;

    explicit NanoReader(const NanoHandle& handle) : accessor_(handle.grid<T>()->getAccessor()) {}

    T operator()(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
        return accessor_.getValue({static_cast<int>(i), static_cast<int>(j), static_cast<int>(k)});
    }
    const Leaf* prepare(const Cell& cell) const { return accessor_.probeLeaf(coord(cell)); }
    template <std::size_t corners, bool ahead = true>
    Values<corners> find(const Cell& cell, const Leaf* leaf) const {
        constexpr auto side = static_cast<int>(Leaf::DIM);
        Values<corners> found;
        for (std::size_t corner = 0; corner < corners; ++corner) {
            const auto bits = static_cast<int>(corner);
            const nanovdb::Coord ijk(cell[0] + (bits & 1), cell[1] + (bits >> 1 & 1),
                                     cell[2] + (bits >> 2));
            if (((ijk[0] ^ cell[0]) | (ijk[1] ^ cell[1]) | (ijk[2] ^ cell[2])) >= side) {
                const Leaf* beside = accessor_.probeLeaf(ijk);
                // Beyond the last node, where its weight is 0.
                found[corner] = beside == nullptr ? found[0] : value(*beside, ijk);
            } else {
                found[corner] = value(*leaf, ijk);
            }
            if constexpr (ahead) prefetch(found[corner]);
        }
        return found;
    }

private:
    static const T* value(const Leaf& leaf, const nanovdb::Coord& ijk) {
        return &leaf.data()->mValues[Leaf::CoordToOffset(ijk)];
    }

    typename nanovdb::NanoGrid<T>::AccessorType accessor_;
};

template <class T>
void add_bytes(const NanoHandle& handle, Footprint& footprint) {
    const std::size_t payload =
        handle.grid<T>()->tree().nodeCount(0) * sizeof(nanovdb::NanoLeaf<T>::DataType::mValues);
    footprint.bytes_payload += payload;
    footprint.bytes_topology += handle.size() - payload;
}

/// Lengths, where all metrics are isotropic.
class NanoLengths {
public:
    using Stored = StoredLength<float>;

    explicit NanoLengths(const std::shared_ptr<const LatticeData>& data)
        : grid_(dense_lengths(data->lattice(), data->field())) {}

    class Reader : public NanoReader<float> {
    public:
        using NanoReader::NanoReader;

        Stored operator()(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
            return length(NanoReader::operator()(i, j, k));
        }
        Stored metric(const auto& at, std::size_t corner) const { return length(*at[corner]); }

    private:
        static Stored length(float h) {
            Stored stored;
            stored.h = h;
            return stored;
        }
    };
    Reader reader() const { return Reader(grid_); }

    void add_to(Footprint& footprint) const { add_bytes<float>(grid_, footprint); }

private:
    NanoHandle grid_;
};

class NanoPair {
public:
    using Stored = Metric;

    explicit NanoPair(const std::shared_ptr<const LatticeData>& data)
        : grids_(data->lattice(), data->field()) {}

    static double bytes_for(const Vector& nodes) { return 2 * dense_vec3s_bytes(nodes); }
    static Metric stored(const Metric& m) { return in_floats(m); }

    class Reader {
        using Nodes = NanoReader<nanovdb::Vec3f>;

    public:
        using Leaves = std::pair<const Nodes::Leaf*, const Nodes::Leaf*>;

        explicit Reader(const NanoPair& pair)
            : diagonals_(pair.grids_.diagonals), off_diagonals_(pair.grids_.off_diagonals) {}

        Metric operator()(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
            return metric_of(diagonals_(i, j, k), off_diagonals_(i, j, k));
        }
        Leaves prepare(const Cell& cell) const {
            return {diagonals_.prepare(cell), off_diagonals_.prepare(cell)};
        }
        template <std::size_t corners, bool ahead = true>
        auto find(const Cell& cell, const Leaves& leaves) const {
            return std::pair(diagonals_.find<corners, ahead>(cell, leaves.first),
                             off_diagonals_.find<corners, ahead>(cell, leaves.second));
        }
        Metric metric(const auto& at, std::size_t corner) const {
            return metric_of(*at.first[corner], *at.second[corner]);
        }

    private:
        Nodes diagonals_, off_diagonals_;
    };
    Reader reader() const { return Reader(*this); }

    void add_to(Footprint& footprint) const {
        add_bytes<nanovdb::Vec3f>(grids_.diagonals, footprint);
        add_bytes<nanovdb::Vec3f>(grids_.off_diagonals, footprint);
    }

private:
    DenseNanoGrids grids_;
};

std::unique_ptr<ControlSpaceBuilder> make(const SpaceOptions& options,
                                          Interpolation interpolation) {
    return make_grid<OwnPrecision<NanoPair, NanoLengths>>(options, interpolation);
}

template <Interpolation interpolation>
CatalogueEntry row(std::string id, std::string description) {
    CatalogueEntry row = grid_row<make, interpolation>(std::move(id), std::move(description));
    row.capabilities = {MetricNodes{.rounding = 1e-6}, VoxelSize()};
    if (interpolation == Interpolation::trilinear) row.capabilities.push_back(FittedValues());
    row.own_precision = "floats";
    return row;
}

}  // namespace

std::vector<CatalogueEntry> nanovdb_rows() {
    std::vector<CatalogueEntry> rows = nanovdb_tiles_rows();
    rows.insert(rows.begin(),
                {row<Interpolation::nearest>("nanovdb-nearest",
                                             "dense NanoVDB, constant: a float grid of lengths, or "
                                             "two Vec3f grids of metrics"),
                 row<Interpolation::trilinear>("nanovdb-trilinear",
                                               "dense NanoVDB, trilinear: a float grid of lengths, "
                                               "or two Vec3f grids of metrics")});
    return rows;
}

}  // namespace controlspace
