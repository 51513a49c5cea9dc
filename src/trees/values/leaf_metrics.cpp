// SPDX-License-Identifier: Apache-2.0
#include "controlspace/trees/leaf_metrics.h"

#include <utility>

#include "trees/model_state.h"
#include "trees/packing/packed_tree.h"

namespace controlspace {

namespace {

/// The compact form: metrics stored as `M`, and a model without metrics, which varies them.
template <class Node, class M>
class VariedLeaves : public PackedLeaves<M, false> {
    using Base = PackedLeaves<M, false>;

public:
    VariedLeaves(std::unique_ptr<LeafMetrics<Node>> model, StoredMetrics<M> metrics)
        : Base(std::move(metrics)), model_(std::move(model)) {}

    void values_in(const Topology<Node>& tree, std::span<const LeafIndex> leaves,
                   std::span<const Point> x, std::span<Metric> out) const {
        Base::values_in(tree, leaves, x, out);
        model_->vary(leaves, x, out);
    }
    void describe(Footprint& footprint) const {
        model_->describe(footprint);
        Base::describe(footprint);
    }
    void save(const Topology<Node>&, StateWriter& state) const {
        save_model(*model_, saved_metrics<M>(this->metrics_.metrics()), state);
    }

private:
    std::unique_ptr<LeafMetrics<Node>> model_;
};

}  // namespace

template <class Node>
void LeafMetrics<Node>::split(const Subdivision& subdivision, LeafIndex leaf, LeafIndex) {
    this->metrics_.repeat(leaf, static_cast<std::size_t>(subdivision.children() - 1));
}

template <class Node>
void LeafMetrics<Node>::values(const Topology<Node>&, std::span<const LeafIndex> leaves,
                               std::span<const Point> x, std::span<Metric> out) const {
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = this->metrics_[leaves[i]];
    vary(leaves, x, out);
}

template <class Node>
std::unique_ptr<ControlSpace> LeafMetrics<Node>::compact(const Topology<Node>& tree,
                                                         Precision precision) const {
    std::vector<LeafIndex> former;
    Topology<Node> ordered = tree.depth_first(former);
    const auto metrics = this->metrics_.field();
    return with_stored<false>(
        precision, metrics, [&]<class M>(std::type_identity<M>) -> std::unique_ptr<ControlSpace> {
            StoredMetrics<M> stored(metrics, former);
            auto copy = this->clone();
            std::unique_ptr<LeafMetrics<Node>> model(
                static_cast<LeafMetrics<Node>*>(copy.release()));
            model->metrics() = NodeMetrics(0, Metric());
            reorder_arrays(*model, former);
            return std::make_unique<PackedTree<Node, VariedLeaves<Node, M>>>(
                std::move(ordered), VariedLeaves<Node, M>(std::move(model), std::move(stored)));
        });
}

template class LeafMetrics<KdNode>;
template class LeafMetrics<OctreeNode>;

}  // namespace controlspace
