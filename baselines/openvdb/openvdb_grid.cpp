#include "baselines/openvdb/openvdb_grid.h"

#include <openvdb/tree/ValueAccessor.h>

#include "baselines/openvdb/dense_tree.h"
#include "baselines/lattice/lattice_space.h"
#include "baselines/openvdb/openvdb_value.h"
#include "baselines/openvdb/vdb_prune.h"

namespace controlspace {

namespace {

class VdbTree {
public:
    VdbTree(const Lattice& lattice, const Metric& initial) : tree_(VdbMetric(initial)) {
        fill_densely(tree_, lattice, VdbMetric(initial));
    }

    static double bytes_for(const Vector& nodes) { return dense_bytes<VdbMetricTree>(nodes); }

    // Accessors that the tree need not know of ("unsafe"), since none lives while its nodes change:
    // registering one takes a lock and an allocation.
    auto reader() const {
        return [nodes = openvdb::tree::ValueAccessor<const VdbMetricTree, false>(tree_)](
                   std::uint32_t i, std::uint32_t j, std::uint32_t k) -> const Metric& {
            return nodes.getValue(voxel(i, j, k)).metric;
        };
    }

    auto writer() {
        struct Writer {
            openvdb::tree::ValueAccessor<VdbMetricTree, false> nodes;
            const Metric& get(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
                return nodes.getValue(voxel(i, j, k)).metric;
            }
            void set(std::uint32_t i, std::uint32_t j, std::uint32_t k, const Metric& m) {
                nodes.setValueOnly(voxel(i, j, k), VdbMetric(m));
            }
        };
        return Writer{openvdb::tree::ValueAccessor<VdbMetricTree, false>(tree_)};
    }

    // Voxels that fill up the outermost leaves are inactive, and nobody reads them.
    void prune(double delta) { prune_metrics(tree_, {.delta = delta, .inactive_count = false}); }

    // Where tiles stand and in which level of the tree, which the metrics alone do not tell.
    void save_tiles(StateWriter& state) const {
        std::vector<std::array<std::uint32_t, 4>> tiles;
        auto tile = tree_.cbeginValueOn();
        tile.setMaxDepth(VdbMetricTree::ValueOnCIter::LEAF_DEPTH - 1);
        for (; tile; ++tile) {
            const openvdb::Coord c = tile.getCoord();
            tiles.push_back({tile.getLevel(), static_cast<std::uint32_t>(c.x()),
                             static_cast<std::uint32_t>(c.y()), static_cast<std::uint32_t>(c.z())});
        }
        state(tiles_name, tiles);
    }
    void load_tiles(const Lattice& lattice, const StateReader& state) {
        std::vector<std::array<std::uint32_t, 4>> tiles;
        state(tiles_name, tiles);
        const auto [nx, ny, nz] = lattice.nodes;
        for (const auto& [level, i, j, k] : tiles) {
            state.require(level > 0 && level < VdbMetricTree::DEPTH && i < nx && j < ny && k < nz,
                          tiles_name, "has a tile out of place");
            const VdbMetric metric = tree_.getValue(voxel(i, j, k));
            tree_.addTile(level, voxel(i, j, k), metric, true);
        }
    }

    void add_to(Footprint& footprint) const { add_dense_bytes(tree_, footprint); }

private:
    static constexpr const char* tiles_name = "grid.tiles";

    VdbMetricTree tree_;
};

}  // namespace

std::unique_ptr<ControlSpaceBuilder> make_openvdb_grid(const SpaceOptions& options,
                                                       Interpolation interpolation) {
    return make_lattice_space<VdbTree>(options, interpolation);
}

}  // namespace controlspace
