// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "controlspace/metric/intersection.h"
#include "controlspace/sources/point_source.h"
#include "controlspace/space/control_space_builder.h"
#include "controlspace/space/insertion.h"
#include "trees/insertion/source_cuts.h"
#include "trees/insertion/source_search.h"
#include "trees/topology/topology.h"

namespace controlspace {

/// Inserts sources into a tree with one metric a leaf on all of TBB's threads, with the result of
/// one source after the other, to the bit and to the numbers of leaves and nodes.
///
/// A source changes the leaf that holds it, and nothing else counts for it. So in a batch of
/// sources, leaves grow at the same time, each by its own sources in their order, into arrays
/// aside. The numbers of cuts of each source then give the numbers that its nodes and leaves would
/// have, had sources come one by one; there they are written.
template <class Node>
class LeafGrowth {
public:
    LeafGrowth(const SourceCuts<Node>& cuts, double tolerance)
        : cuts_(cuts), tolerance_(tolerance), let_pass_(length_let_pass(tolerance)) {}

    /// The next batch of what is left: such that the arrays aside stay small beside the tree.
    std::span<const PointSource> next_batch(std::span<const PointSource> left) {
        if (32 * cuts_made() < nodes_before_) length_ = std::min(2 * length_, longest);
        if (16 * cuts_made() > nodes_before_) length_ = std::max(length_ / 2, shortest);
        return left.first(std::min(length_, left.size()));
    }

    /// Grows leaves aside by the sources of `batch`, in so far as they are valid. Returns how many
    /// that are; `metrics` are those of the leaves.
    std::size_t grow(const Topology<Node>& tree, std::span<Metric> metrics,
                     std::span<const PointSource> batch) {
        nodes_before_ = tree.inner_nodes();
        leaves_before_ = tree.leaves();
        metrics_ = metrics;
        const std::size_t valid = list_sources(tree, batch);
        first_cut_.assign(valid + 1, 0);
        first_leaf_.assign(valid + 1, 0);
        shares_.resize(std::min(most_shares, growing_.size()));
        const auto border = [&](std::size_t s) { return s * growing_.size() / shares_.size(); };
        tbb::parallel_for(std::size_t{0}, shares_.size(), [&](std::size_t s) {
            shares_[s].clear();
            for (std::size_t i = border(s); i < border(s + 1); ++i) {
                grow_leaf(tree, batch, growing_[i], shares_[s]);
            }
        });
        std::partial_sum(first_cut_.begin(), first_cut_.end(), first_cut_.begin());
        std::partial_sum(first_leaf_.begin(), first_leaf_.end(), first_leaf_.begin());
        return valid;
    }

    /// How many nodes and leaves more `grow` has made, and how many of its sources were inserted.
    std::size_t cuts_made() const { return first_cut_.back(); }
    std::size_t leaves_made() const { return first_leaf_.back(); }
    std::uint64_t inserted() const {
        return std::accumulate(
            shares_.begin(), shares_.end(), std::uint64_t{0},
            [](std::uint64_t sum, const Share& share) { return sum + share.inserted; });
    }

    /// Bytes of what has grown aside.
    std::size_t bytes() const {
        return std::accumulate(
            shares_.begin(), shares_.end(), std::size_t{0},
            [](std::size_t sum, const Share& share) { return sum + share.bytes(); });
    }

    /// Enters what has grown into the tree, which has got room for it, and into the metrics.
    void enter(Topology<Node>& tree, std::span<Metric> metrics) {
        for (const Share& share : shares_) tree.deepen_to(share.deepest);
        tbb::parallel_for(std::size_t{0}, shares_.size(),
                          [&](std::size_t s) { enter_share(shares_[s], tree, metrics); });
    }

private:
    static constexpr std::size_t shortest = 512, longest = 65536;
    static constexpr std::size_t most_shares = 64;
    static constexpr std::uint32_t none = ~std::uint32_t{0};

    // A leaf of the tree that was cut, and what it has become.
    struct Root {
        LeafPlace place;
        Ref part;
    };
    // Nodes and leaves made from some leaves. Nodes are numbered from 0 on, new leaves from the
    // tree's number of leaves on.
    struct Share {
        std::vector<Root> roots;
        std::vector<Node> nodes;
        std::vector<std::uint32_t> numbers;  // of nodes: the source; then which of all new ones
        std::vector<std::uint32_t> leaves;   // of nodes: the first of their new leaves
        std::vector<Metric> metrics;         // of the new leaves
        std::vector<std::uint32_t> makers;   // their nodes
        std::uint64_t inserted = 0;
        int deepest = 0;

        std::size_t bytes() const {
            return roots.capacity() * sizeof(Root) + nodes.capacity() * sizeof(Node) +
                   metrics.capacity() * sizeof(Metric) +
                   (numbers.capacity() + leaves.capacity() + makers.capacity()) *
                       sizeof(std::uint32_t);
        }
        void clear() {
            roots.clear();
            nodes.clear();
            numbers.clear();
            leaves.clear();
            metrics.clear();
            makers.clear();
            inserted = 0;
            deepest = 0;
        }
    };

    // Lists the sources that may change something, for each leaf those that it holds, in their
    // order. Returns how many sources there are before the first that is not valid.
    std::size_t list_sources(const Topology<Node>& tree, std::span<const PointSource> batch) {
        next_.resize(batch.size());
        std::atomic<std::size_t> valid = batch.size();
        find_leaves(
            tree, batch,
            [&](std::size_t first, std::span<const Point>, std::span<const LeafIndex> leaves) {
                for (const LeafIndex leaf : leaves) __builtin_prefetch(&metrics_[leaf]);
                for (std::size_t k = 0; k < leaves.size(); ++k) {
                    const PointSource& source = batch[first + k];
                    if (!is_valid(source, tree.domain())) lower_to(valid, first + k);
                    const bool met = is_met(source.metric, metrics_[leaves[k]]);
                    next_[first + k] = met ? none : leaves[k];
                }
            });
        first_.resize(tree.leaves(), none);
        growing_.clear();
        for (std::size_t k = valid; k-- > 0;) {
            const LeafIndex leaf = next_[k];
            if (leaf == none) continue;
            next_[k] = std::exchange(first_[leaf], static_cast<std::uint32_t>(k));
            if (next_[k] == none) growing_.push_back(leaf);
        }
        return valid;
    }

    static void lower_to(std::atomic<std::size_t>& least, std::size_t i) {
        std::size_t old = least.load();
        while (i < old && !least.compare_exchange_weak(old, i)) {
        }
    }

    // What calls_for_change knows at once.
    bool is_met(const Metric& requested, const Metric& held) const {
        return is_isotropic(requested) && is_isotropic(held) && held.xx <= let_pass_ * requested.xx;
    }

    // By all of its sources.
    void grow_leaf(const Topology<Node>& tree, std::span<const PointSource> batch, LeafIndex leaf,
                   Share& share) {
        LeafPlace root;
        LeafPlace place;  // of the source before, which often is the next one's too
        place.leaf = leaf;
        Ref part = Ref::leaf(leaf);  // what the leaf has become
        for (std::uint32_t k = std::exchange(first_[leaf], none); k != none; k = next_[k]) {
            const PointSource& source = batch[k];
            if (!part.is_leaf() && !is_inside(source.position, place.box)) {
                place = descend(share, part, root, source);
            }
            const Metric& held = metric(place.leaf, share);
            if (is_met(source.metric, held) || !calls_for_change(source.metric, held, tolerance_)) {
                continue;
            }
            ++share.inserted;
            if (part.is_leaf()) place = root = tree.locate(source.position);
            while (const auto cut = cuts_.cut(place, source)) {
                const Ref inner = append(*cut, place.leaf, k, share);
                if (part.is_leaf()) {
                    part = inner;
                    share.roots.push_back({root, inner});
                } else {
                    share.nodes[place.slot / Node::arity].set_child(place.slot % Node::arity,
                                                                    inner);
                }
                place = descend(share, inner, place, source);
                ++first_cut_[k + 1];
                first_leaf_[k + 1] += static_cast<std::uint32_t>(cut->children() - 1);
            }
            share.deepest = std::max(share.deepest, place.level);
            Metric& own = metric(place.leaf, share);
            own = intersection(own, source.metric);
        }
    }

    // A place on a plane belongs to the low side.
    static bool is_inside(const Point& x, const Box& box) {
        return (x.array() > box.low.array()).all() && (x.array() <= box.high.array()).all();
    }

    static LeafPlace descend(const Share& share, Ref part, const LeafPlace& place,
                             const PointSource& source) {
        return controlspace::descend(std::span(share.nodes), part, place, source.position);
    }

    Metric& metric(LeafIndex leaf, Share& share) {
        return leaf < leaves_before_ ? metrics_[leaf] : share.metrics[leaf - leaves_before_];
    }

    // A node in place of a leaf, which goes on as its first child.
    Ref append(const Subdivision& subdivision, LeafIndex leaf, std::uint32_t source, Share& share) {
        const auto first = static_cast<std::uint32_t>(share.metrics.size());
        const auto made = static_cast<std::size_t>(subdivision.children() - 1);
        const auto number = static_cast<std::uint32_t>(share.nodes.size());
        share.leaves.push_back(first);
        share.metrics.insert(share.metrics.end(), made, Metric(metric(leaf, share)));
        share.makers.insert(share.makers.end(), made, number);
        auto next = static_cast<LeafIndex>(leaves_before_ + first);
        Node node(subdivision);
        node.set_child(0, Ref::leaf(leaf));
        for (int c = 1; c < node.count(); ++c) node.set_child(node.slot(c), Ref::leaf(next++));
        share.nodes.push_back(node);
        share.numbers.push_back(source);
        return Ref::inner(share.nodes.size() - 1);
    }

    void enter_share(Share& share, Topology<Node>& tree, std::span<Metric> metrics) const {
        // Of each node, by how much the numbers of its new leaves move.
        std::vector<std::uint32_t> moves(share.nodes.size());
        std::uint32_t source = none;
        std::uint32_t next_leaf = 0;
        for (std::size_t n = 0; n < share.nodes.size(); ++n) {
            std::uint32_t& number = share.numbers[n];
            const bool goes_on = std::exchange(source, number) == number;
            if (!goes_on) next_leaf = first_leaf_[number];
            number = goes_on ? share.numbers[n - 1] + 1 : first_cut_[number];
            moves[n] = next_leaf - share.leaves[n];  // modulo 2^32
            next_leaf += static_cast<std::uint32_t>(share.nodes[n].count() - 1);
        }
        const auto entered = [&](Ref ref) {
            if (!ref.is_leaf()) return Ref::inner(nodes_before_ + share.numbers[ref.index()]);
            if (ref.index() < leaves_before_) return ref;
            return Ref::leaf(ref.index() + moves[share.makers[ref.index() - leaves_before_]]);
        };
        for (std::size_t n = 0; n < share.nodes.size(); ++n) {
            Node node = share.nodes[n];
            for (int c = 0; c < node.count(); ++c) {
                node.set_child(node.slot(c), entered(node.children[node.slot(c)]));
            }
            tree.enter(nodes_before_ + share.numbers[n], node);
            const std::uint32_t first = share.leaves[n];
            std::copy_n(
                share.metrics.begin() + static_cast<std::ptrdiff_t>(first), node.count() - 1,
                metrics.begin() +
                    static_cast<std::ptrdiff_t>(leaves_before_ + std::uint32_t(first + moves[n])));
        }
        for (const Root& root : share.roots) tree.graft(root.place, entered(root.part));
    }

    const SourceCuts<Node>& cuts_;
    double tolerance_, let_pass_;
    std::size_t length_ = shortest;
    std::size_t nodes_before_ = 0, leaves_before_ = 1;  // of the tree
    std::span<Metric> metrics_;                         // of the tree's leaves
    std::vector<LeafIndex> growing_;                    // leaves with sources of the batch
    std::vector<std::uint32_t> first_;                  // source of each leaf, and
    std::vector<std::uint32_t> next_;                   // the next one in the same leaf
    std::vector<std::uint32_t> first_cut_{0};           // of each source among all of the batch
    std::vector<std::uint32_t> first_leaf_{0};          // likewise, of the new leaves
    std::vector<Share> shares_;
};

}  // namespace controlspace
