#include "baselines/openvdb_grid.h"

#include <openvdb/tree/ValueAccessor.h>

#include "baselines/lattice_space.h"
#include "baselines/openvdb_value.h"
#include "baselines/vdb_prune.h"

namespace controlspace {

namespace {

using Leaf = VdbMetricTree::LeafNodeType;
using LowerNode = VdbMetricTree::RootNodeType::ChildNodeType::ChildNodeType;
using UpperNode = VdbMetricTree::RootNodeType::ChildNodeType;

constexpr double leaf_payload = Leaf::SIZE * sizeof(VdbMetric);

openvdb::Coord voxel(std::uint32_t i, std::uint32_t j, std::uint32_t k) {
    return {static_cast<openvdb::Int32>(i), static_cast<openvdb::Int32>(j),
            static_cast<openvdb::Int32>(k)};
}

// Index space starts at 0, since a box around the origin would touch up to eight upper nodes of
// 1.6 MB each. The tree stands without openvdb::Grid: all that Grid adds is a transform, which
// would be a virtual call per point. openvdb::initialize() is not called: it serves files alone.
class VdbTree {
public:
    VdbTree(const Lattice& lattice, const Metric& initial) : tree_(VdbMetric(initial)) {
        const auto [nx, ny, nz] = lattice.nodes;
        // What denseFill does, but on the one thread that makes every other structure too.
        tree_.sparseFill({voxel(0, 0, 0), voxel(nx - 1, ny - 1, nz - 1)}, VdbMetric(initial));
        tree_.voxelizeActiveTiles(/*threaded=*/false);
    }

    static double bytes_for(const Vector& nodes) {
        const auto blocks = [&](double side) { return (nodes.array() / side).ceil().prod(); };
        return blocks(Leaf::DIM) * (sizeof(Leaf) + leaf_payload) +
               blocks(LowerNode::DIM) * sizeof(LowerNode) +
               blocks(UpperNode::DIM) * sizeof(UpperNode) + sizeof(VdbMetricTree);
    }

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

    void add_to(Footprint& footprint) const {
        const auto payload = tree_.leafCount() * static_cast<std::size_t>(leaf_payload);
        footprint.bytes_payload += payload;
        footprint.bytes_topology += tree_.memUsage() - payload;
    }

private:
    VdbMetricTree tree_;
};

}  // namespace

std::unique_ptr<ControlSpace> make_openvdb_grid(const SpaceOptions& options,
                                                Interpolation interpolation) {
    return make_lattice_space<VdbTree>(options, interpolation);
}

}  // namespace controlspace
