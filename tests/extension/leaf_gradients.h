// SPDX-License-Identifier: Apache-2.0
// A storage of one's own: a leaf holds a metric and its gradient. The field in a leaf is linear,
// M (a + s·x), where M is the metric at the centre of the leaf and a + s·x a factor that is 1 there
// and positive in the whole leaf.
#pragma once

#include <controlspace/trees/leaf_metrics.h>
#include <controlspace/trees/tree_row.h>

#include <algorithm>
#include <array>
#include <vector>

using namespace controlspace;

/// The node of a leaf is its centre, as in LeafMetrics.
class LeafGradients : public LeafMetrics {
public:
    static constexpr int order = 1;
    static constexpr CutBy cut_by = CutBy::faces;  // it is exact at the centre of a leaf

    explicit LeafGradients(const SpaceOptions& options)
        : LeafMetrics(options), factors_{constant} {}

    template <class Node, class M>
    Metric value_in(const Topology<Node>& tree, LeafIndex leaf, const Point& x,
                    const NodeView<M>& nodes) const {
        const Box& domain = tree.domain();
        const Point inside = x.cwiseMax(domain.low).cwiseMin(domain.high);
        return factor_at(inside, factors_[leaf]) * Metric(nodes[leaf]);
    }

    // The children continue the function of their parent.
    void split(const Subdivision& subdivision, LeafIndex leaf, LeafIndex first_new) {
        LeafMetrics::split(subdivision, leaf, first_new);
        const Factor parent = factors_[leaf];
        factors_.resize(metrics_.size());
        for (int c = 0; c < subdivision.children(); ++c) {
            const LeafIndex child = c == 0 ? leaf : first_new++;
            factors_[child] = parent;
            const double at_centre = factor_at(subdivision.child(c).centre(), parent);
            metrics_.scale(child, at_centre);
            for (double& number : factors_[child]) number /= at_centre;
        }
    }

    // At a source the leaf becomes constant, no longer than it was anywhere.
    void lower(const LeafPlace& place, const Metric& metric) {
        Factor& factor = factors_[place.leaf];
        double least = 1;
        for (int i = 0; i < 8; ++i)
            least = std::min(least, factor_at(corner(place.box, i), factor));
        metrics_.scale(place.leaf, least);
        metrics_.lower(place.leaf, metric);
        factor = constant;
    }
    void assigned() { factors_.assign(metrics_.size(), constant); }

    // The metric at the centre, and the growth of its mean length between opposite faces.
    void fit(const LeafBox& of, const ControlSpace& field) {
        const Point centre = of.box.centre();
        const Metric m = sample_at(field, centre);
        const Vector half = 0.5 * of.box.edges();
        Vector growth;  // from the centre to the high faces
        for (Axis a = 0; a < 3; ++a) {
            const Vector step = half[a] * Vector::Unit(a);
            const double high = mean_length(sample_at(field, centre + step));
            const double low = mean_length(sample_at(field, centre - step));
            growth[a] = 0.5 * (high - low) / mean_length(m);
        }
        constexpr double most = 0.9;  // so that it is positive at all corners
        growth *= std::min(1.0, most / growth.lpNorm<1>());
        const Vector slope = growth.cwiseQuotient(half);
        metrics_.set(of.leaf, m);
        factors_[of.leaf] = {1 - slope.dot(centre), slope.x(), slope.y(), slope.z()};
    }

    static void data(auto& self, auto&& visit) { visit("gradients.factors", self.factors_); }

private:
    using Factor = std::array<double, 4>;  // a, s
    static constexpr Factor constant{1, 0, 0, 0};
    static double factor_at(const Point& x, const Factor& f) {
        return f[0] + f[1] * x.x() + f[2] * x.y() + f[3] * x.z();
    }

    std::vector<Factor> factors_;  // of the leaves
};
