// SPDX-License-Identifier: Apache-2.0
// The leaves of K_oL as tiles and voxels of a sparse NanoVDB grid, made from OpenVDB's: of floats,
// or of codes of 8 bits between the least and the largest value of each of its leaves.
#include "baselines/peers/nanovdb/nano_tiles.h"

#include <fmt/format.h>
#include <nanovdb/NanoVDB.h>
#include <nanovdb/util/OpenToNanoVDB.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "baselines/openvdb/octree_voxels.h"
#include "baselines/openvdb/voxel_boxes_tree.h"
#include "baselines/peers/converted_builder.h"
#include "baselines/peers/nanovdb/dense_grid.h"
#include "baselines/peers/peer_builder.h"
#include "controlspace/space/control_space_file.h"
#include "controlspace/trees/node_metrics.h"
#include "refuse.h"
#include "space/saved.h"
#include "trees/topology/topology_state.h"

namespace controlspace {

namespace {

/// K_oL's octree, and the length in each leaf.
struct Lengths {
    Octants octree;
    VoxelBoxes boxes;
    std::vector<float> of_leaves;

    explicit Lengths(const ControlSpace& space) : Lengths(state_of(space), space.domain()) {}

private:
    static std::string state_of(const ControlSpace& space) {
        StateWriter state;
        dynamic_cast<const Saved&>(space).save(state);
        return state.bytes();
    }
    Lengths(const std::string& bytes, const Box& domain)
        : Lengths(StateReader(bytes, "the octree"), domain) {}
    Lengths(const StateReader& state, const Box& domain)
        : octree(load_topology<OctreeNode>(domain, state)), boxes(octree) {
        NodeMetrics metrics{std::vector<Metric>()};
        NodeMetrics::exchange(metrics, state);
        for (const Metric& metric : metrics.field()) {
            if (!is_isotropic(metric)) {
                refuse("sparse NanoVDB grids hold lengths: take nanovdb-nearest for tensors");
            }
            of_leaves.push_back(static_cast<float>(metric.xx));
        }
        constexpr std::int32_t most = 1 << 16;
        if (std::ranges::max(boxes.voxels) > most) {
            refuse("a NanoVDB grid of more than {} voxels along an axis: lower --max-depth", most);
        }
    }
};

template <class Number>
NanoHandle nano_grid(const Lengths& content) {
    const auto grid = openvdb::FloatGrid::create();
    fill(grid->tree(), content.boxes, [&](LeafIndex leaf) { return content.of_leaves[leaf]; });
    nanovdb::OpenToNanoVDB<float, Number> convert;
    convert.setStats(nanovdb::StatsMode::Disable);
    convert.setChecksum(nanovdb::ChecksumMode::Disable);
    return convert(*grid);
}

template <class Number>
class NanoTiles final : public LengthSpace {
    using Grid = nanovdb::NanoGrid<Number>;
    static constexpr bool has_codes = !std::is_same_v<Number, float>;

public:
    static std::unique_ptr<ControlSpaceBuilder> ours(const SpaceOptions& options) {
        return find_entry(tree_catalogue(), "K_oL")->make(options);
    }
    /// What rounding mostly takes, before it is known.
    static constexpr double float_rounding = 1 + 1.2e-7;
    static constexpr double usual_rounding = has_codes ? 1.01 : float_rounding;

    explicit NanoTiles(const ControlSpace& octree) : NanoTiles(Lengths(octree), octree) {}

    double length_at(const Point& x) const override {
        return grid_->getAccessor().getValue(coord(voxel_of_(x)));
    }
    Metric metric_at(const Point& x) const override { return Metric::isotropic(length_at(x)); }
    std::unique_ptr<Cursor> cursor() const override { return std::make_unique<NanoCursor>(*this); }
    Footprint footprint() const override { return footprint_; }

    /// Largest factor between the octree's lengths and those that are answered.
    double rounding() const { return rounding_; }

protected:
    void lengths(std::span<const Point> x, std::span<double> out) const override {
        const auto accessor = grid_->getAccessor();
        CellBatch batch;
        for (std::size_t first = 0; first < x.size(); first += CellBatch::most) {
            const std::size_t count = std::min(CellBatch::most, x.size() - first);
            voxel_of_.locate(x.subspan(first, count), batch);
            for (std::size_t i = 0; i < count; ++i) {
                out[first + i] = accessor.getValue(coord(batch[i]));
            }
        }
    }

private:
    NanoTiles(const Lengths& content, const ControlSpace& octree)
        : LengthSpace(octree.domain()),
          voxel_of_(octree.domain(), content.boxes.voxels),
          handle_(nano_grid<Number>(content)),
          grid_(handle_.template grid<Number>()) {
        double largest = 1;  // factor between floats and codes
        const auto accessor = grid_->getAccessor();
        for (const auto& [leaf, low, edges] : content.boxes.leaves) {
            // What fills a leaf of NanoVDB has no range there, and is held as it is. Of the others
            // voxels in one leaf have one code.
            constexpr std::int32_t side = 8;
            if (std::ranges::min(edges) >= side) continue;
            for (Cell at = low; at[0] < low[0] + edges[0]; at[0] += side) {
                for (at[1] = low[1]; at[1] < low[1] + edges[1]; at[1] += side) {
                    for (at[2] = low[2]; at[2] < low[2] + edges[2]; at[2] += side) {
                        const double h = content.of_leaves[leaf];
                        const double held = accessor.getValue(coord(at));
                        largest = std::max({largest, h / held, held / h});
                    }
                }
            }
        }
        rounding_ = float_rounding * largest;
        const auto& tree = grid_->tree();
        footprint_.cells = footprint_.control_nodes = content.of_leaves.size();
        footprint_.tree_nodes = tree.nodeCount(0) + tree.nodeCount(1) + tree.nodeCount(2);
        footprint_.depth = 3;
        footprint_.bytes_payload =
            tree.nodeCount(0) * nanovdb::NanoLeaf<Number>::SIZE * (has_codes ? 1 : sizeof(float));
        footprint_.bytes_topology = handle_.size() - footprint_.bytes_payload;
    }

    static nanovdb::Coord coord(const Cell& voxel) { return {voxel[0], voxel[1], voxel[2]}; }

    /// Keeps an accessor, which remembers the last nodes.
    class NanoCursor final : public Cursor {
    public:
        explicit NanoCursor(const NanoTiles& tiles)
            : tiles_(tiles), accessor_(tiles.grid_->getAccessor()) {}

        double length_at(const Point& x) override {
            return accessor_.getValue(coord(tiles_.voxel_of_(x)));
        }
        Metric metric_at(const Point& x) override { return Metric::isotropic(length_at(x)); }

    private:
        const NanoTiles& tiles_;
        typename Grid::AccessorType accessor_;
    };

    VoxelOfPlace voxel_of_;
    NanoHandle handle_;
    const Grid* grid_;
    double rounding_ = 1;
    Footprint footprint_;
};

}  // namespace

std::vector<CatalogueEntry> nanovdb_tiles_rows() {
    CatalogueEntry floats = converted_row<NanoTiles<float>>(
        "nanovdb-tiles", "NanoVDB, sparse: K_oL's leaves as tiles and voxels of a float grid");
    floats.own_precision = "floats";
    CatalogueEntry codes = converted_row<NanoTiles<nanovdb::Fp8>>(
        "nanovdb-tiles-fp8",
        "the same in 8 bits, between the least and the largest value of each leaf of NanoVDB");
    codes.own_precision = "8 bits";
    return {std::move(floats), std::move(codes)};
}

}  // namespace controlspace
