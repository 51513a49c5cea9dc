#include "baselines/openvdb_grid.h"

#include <openvdb/tree/ValueAccessor.h>

#include "baselines/dense_tree.h"
#include "baselines/lattice_space.h"
#include "baselines/openvdb_value.h"
#include "baselines/vdb_prune.h"

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

    void add_to(Footprint& footprint) const { add_dense_bytes(tree_, footprint); }

private:
    VdbMetricTree tree_;
};

}  // namespace

std::unique_ptr<ControlSpace> make_openvdb_grid(const SpaceOptions& options,
                                                Interpolation interpolation) {
    return make_lattice_space<VdbTree>(options, interpolation);
}

}  // namespace controlspace
