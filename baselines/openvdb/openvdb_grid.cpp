#include "baselines/lattice/grid_space.h"
#include "baselines/openvdb/catalogue.h"
#include "baselines/openvdb/dense_tree.h"
#include "baselines/openvdb/openvdb_value.h"
#include "baselines/openvdb/prune.h"

namespace controlspace {

namespace {

class VdbTree {
public:
    static constexpr bool shares_field = false;

    explicit VdbTree(const std::shared_ptr<const LatticeData>& data)
        : tree_(VdbMetric(largest_metric(data->options()))) {
        fill_densely(tree_, data->lattice(), data->field(),
                     [](const Metric& m) { return VdbMetric(m); });
        const double delta = data->options().prune_delta;
        // Voxels that fill up the outermost leaves are inactive, and nobody reads them.
        if (delta > 0) prune_metrics(tree_, delta);
    }

    static double bytes_for(const Vector& nodes) { return dense_bytes<VdbMetricTree>(nodes); }

    struct Reader : DenseReader<VdbMetricTree> {
        using DenseReader::DenseReader;
        const Metric& operator()(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
            return DenseReader::operator()(i, j, k).metric;
        }
        template <std::size_t corners>
        const Metric& metric(const std::array<const VdbMetric*, corners>& at,
                             std::size_t corner) const {
            return at[corner]->metric;
        }
    };
    Reader reader() const { return Reader(tree_); }

    void add_to(Footprint& footprint) const { add_dense_bytes(tree_, footprint); }

private:
    VdbMetricTree tree_;
};

}  // namespace

std::unique_ptr<ControlSpaceBuilder> make_openvdb_grid(const SpaceOptions& options,
                                                       Interpolation interpolation) {
    return make_grid<VdbTree>(options, interpolation);
}

}  // namespace controlspace
