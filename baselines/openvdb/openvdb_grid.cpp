// SPDX-License-Identifier: Apache-2.0
#include <optional>
#include <type_traits>
#include <vector>

#include "baselines/lattice/grid_space.h"
#include "baselines/openvdb/catalogue.h"
#include "baselines/openvdb/dense_tree.h"
#include "baselines/openvdb/prune.h"
#include "baselines/openvdb/stored_value.h"

namespace controlspace {

namespace {

template <class M>
class VdbTree {
    using Value = VdbValue<M>;
    using Tree = VdbTree543<typename Value::Type>;

public:
    using Stored = M;

    explicit VdbTree(const std::shared_ptr<const LatticeData>& data) {
        if constexpr (std::is_same_v<M, Metric>) {
            fill(*data, data->field());
        } else {
            if (is_code && data->options().prune_delta > 0) {
                // Voxels are joined first: what codes stand for depends on the lengths that are
                // left, so that they are the same after a file.
                stored_.emplace(joined(data));
            } else {
                stored_.emplace(data->field());
            }
            fill(*data, stored_->items());
            stored_->drop_items();
        }
    }

    static double bytes_for(const Vector& nodes) { return dense_bytes<Tree>(nodes); }

    using Reader = StoredReader<M, Tree>;
    Reader reader() const { return {tree_, value()}; }

    void add_to(Footprint& footprint) const {
        add_dense_bytes(tree_, footprint);
        if (stored_) footprint.bytes_payload += stored_->bytes();
    }

private:
    static constexpr bool is_code = Value::is_code;

    static std::vector<Metric> joined(const std::shared_ptr<const LatticeData>& data) {
        const VdbTree<StoredLength<double>> tree(data);
        const auto read = tree.reader();
        const Lattice lattice = data->lattice();
        std::vector<Metric> metrics(lattice.size());
        for (NodeIndex n = 0; n < metrics.size(); ++n) {
            const auto [i, j, k] = lattice.coordinates(n);
            metrics[n] = read(i, j, k);
        }
        return metrics;
    }
    void fill(const LatticeData& data, const auto& items) {
        fill_densely(tree_, data.lattice(), [&](NodeIndex node) { return Value::of(items[node]); });
        const double delta = data.options().prune_delta;
        // Voxels that fill up the outermost leaves are inactive, and nobody reads them.
        if (delta > 0) {
            prune_metrics(tree_, is_code ? 0 : delta,
                          [value = value()](const auto& v) { return Metric(value(v)); });
        }
    }
    Value value() const { return vdb_value<M>(stored_); }

    VdbStored<M> stored_;  // how codes are packed, without items
    Tree tree_{typename Value::Type(0)};
};

}  // namespace

std::unique_ptr<ControlSpaceBuilder> make_openvdb_grid(const SpaceOptions& options,
                                                       Interpolation interpolation) {
    return make_grid<AnyPrecision<VdbTree>>(options, interpolation);
}

}  // namespace controlspace
