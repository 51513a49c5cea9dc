// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <queue>
#include <utility>
#include <vector>

#include "controlspace/gradation/grade.h"
#include "controlspace/gradation/law.h"

namespace controlspace {

/// The gradation that a field has been through.
struct PastGradation {
    GradationOptions options;
    double largest_ratio_left = 1;
};

/// Whether a field that has been graded may be graded anew where it has changed alone, with the
/// result of grading all of it, to the bit, if its metrics are isotropic. That takes the same
/// options as before and the one law whose fixed point does not depend on the order: the cone law,
/// followed to the end.
inline bool may_regrade(const std::optional<PastGradation>& past, const GradationOptions& options) {
    return past && past->options == options && options.law == GradationLaw::cone &&
           options.schedule == GradationSchedule::queue;
}

/// Whether so many changes to `nodes` nodes are too many to be followed one by one.
inline bool are_many(std::size_t changes, std::size_t nodes) { return changes > nodes / 8; }

/// Grades isotropic metrics under the cone law where they have changed since the last time, at a
/// cost in proportion to the nodes that end up with another size, and those that changed.
///
/// A size is the least of what is requested at its node and of its neighbours' cones (law.h). Old
/// sizes at or above their new value are harmless: lowering them by the cones of their neighbours
/// ends in the same field. Sizes that are too small now are those whose chain of limiting nodes was
/// broken. They are found first, along the chains, and reset to what is requested (Ramalingam and
/// Reps, J. Algorithms 21, 1996). Then sizes spread from all nodes concerned, smallest first, so
/// that each is final when its turn comes.
///
/// `Nodes` provides:
///   Node                                 names a control node, cheap to copy
///   double requested(node), field(node)  size as the sources request it; as gradation left it,
///                                        or lowered since to what is requested
///   void set(node, double)               sets the latter
///   for_each_link(node, visit(other, v)) its neighbours and the way there, as ControlGraph has it
template <class Nodes>
class Regradation {
public:
    using Node = typename Nodes::Node;

    Regradation(Nodes& nodes, double g) : nodes_(nodes), g_(g) {}

    /// The node requests less than before. The same for both ends of a new link.
    void touch(const Node& node) { waiting_.emplace(nodes_.field(node), node); }

    /// The node is new: it takes what is requested.
    void renew(const Node& node) {
        nodes_.set(node, nodes_.requested(node));
        renewed_.push_back(node);
    }

    /// Whether a neighbour of size `h`, lost since, may be what limited the node at distance v.
    bool may_depend_on(const Node& node, double h, const Vector& v) const {
        const double held = nodes_.field(node);
        return held < nodes_.requested(node) && held >= cone_limit(h, g_, v);
    }

    /// The node may have lost what limited it: resets it to what is requested. To be called
    /// after all `renew`.
    void release(const Node& node) {
        const double held = nodes_.field(node);
        if (held >= nodes_.requested(node)) return;
        nodes_.set(node, nodes_.requested(node));
        released_.emplace_back(held, node);
    }

    GradationReport run(double largest_ratio_before) {
        report_ = {.largest_ratio_left = largest_ratio_before, .visits = 0};
        release_followers();
        for (const auto& [held, node] : released_) pull(node);
        for (const Node& node : renewed_) pull(node);
        push_all();
        return report_;
    }

private:
    using Sized = std::pair<double, Node>;
    struct Larger {
        bool operator()(const Sized& a, const Sized& b) const { return a.first > b.first; }
    };

    template <class Visit>
    void visit_links(const Node& node, Visit&& visit) {
        ++*report_.visits;
        nodes_.for_each_link(node, visit);
    }

    void release_followers() {
        for (std::size_t k = 0; k < released_.size(); ++k) {
            const auto [held, node] = released_[k];
            visit_links(node, [&, h = held](const Node& other, const Vector& v) {
                if (may_depend_on(other, h, v)) release(other);
            });
        }
    }

    // What the neighbours allow so far.
    void pull(const Node& node) {
        double size = nodes_.field(node);
        visit_links(node, [&](const Node& other, const Vector& v) {
            size = std::min(size, cone_limit(nodes_.field(other), g_, v));
        });
        lower(node, size);
    }

    // To a size no larger than before; the node waits for its turn to limit its neighbours.
    void lower(const Node& node, double size) {
        if (size < nodes_.field(node)) ++report_.operations;
        nodes_.set(node, size);
        waiting_.emplace(size, node);
    }

    void push_all() {
        while (!waiting_.empty()) {
            const auto [size, node] = waiting_.top();
            waiting_.pop();
            if (size != nodes_.field(node)) continue;  // released, or lowered and waiting again
            visit_links(node, [&, h = size](const Node& other, const Vector& v) {
                const double limit = cone_limit(h, g_, v);
                if (nodes_.field(other) > limit) lower(other, limit);
                note_growth(h, nodes_.field(other), v);
            });
        }
    }

    void note_growth(double a, double b, const Vector& v) {
        const auto [small, large] = std::minmax(a, b);
        const Growth growth{large / small, v.norm() / small};
        report_.largest_ratio_left = std::max(report_.largest_ratio_left, growth.gradation());
    }

    Nodes& nodes_;
    double g_;
    std::vector<Node> renewed_;
    std::vector<Sized> released_;  // with the size they were held at
    std::priority_queue<Sized, std::vector<Sized>, Larger> waiting_;
    GradationReport report_;
};

}  // namespace controlspace
