// SPDX-License-Identifier: Apache-2.0
// A model of one's own: a leaf holds a metric and its gradient. The field in a leaf is linear,
// M (a + s·x), where M is the metric at the centre of the leaf and a + s·x a factor that is 1 there
// and positive in the whole leaf.
#pragma once

#include <controlspace/trees/leaf_metrics.h>
#include <controlspace/trees/tree_row.h>

#include <algorithm>

using namespace controlspace;

template <class Node>
class LeafGradients final : public LeafMetrics<Node> {
public:
    static constexpr ModelTraits model_traits{.order = 1, .cut_by = CutBy::faces};

    explicit LeafGradients(const SpaceOptions& options)
        : LeafMetrics<Node>(options, model_traits), domain_(options.domain), factors_{constant} {}
    std::unique_ptr<LeafModel<Node>> clone() const override {
        return std::make_unique<LeafGradients>(*this);
    }

    void vary(std::span<const LeafIndex> leaves, std::span<const Point> x,
              std::span<Metric> metrics) const override {
        for (std::size_t i = 0; i < x.size(); ++i) {
            const Point inside = x[i].cwiseMax(domain_.low).cwiseMin(domain_.high);
            metrics[i] = factor_at(inside, factors_[leaves[i]]) * metrics[i];
        }
    }

    // The children continue the function of their parent.
    void split(const Subdivision& subdivision, LeafIndex leaf, LeafIndex first_new) override {
        LeafMetrics<Node>::split(subdivision, leaf, first_new);
        const Factor parent = factors_[leaf];
        factors_.resize(this->metrics().size());
        for (int c = 0; c < subdivision.children(); ++c) {
            const LeafIndex child = c == 0 ? leaf : first_new++;
            factors_[child] = parent;
            const double at_centre = factor_at(subdivision.child(c).centre(), parent);
            this->metrics().scale(child, at_centre);
            for (double& number : factors_[child]) number /= at_centre;
        }
    }

    // At a source the leaf becomes constant, no longer than it was anywhere.
    void lower(const CellBox& leaf, const Metric& metric) override {
        double least = 1;
        const Factor& f = factors_[leaf.cell];
        for (int i = 0; i < 8; ++i) least = std::min(least, factor_at(corner(leaf.box, i), f));
        this->metrics().scale(leaf.cell, least);
        this->metrics().lower(leaf.cell, metric);
        factors_[leaf.cell] = constant;
    }
    void assigned() override { factors_.assign(this->metrics().size(), constant); }

    // The metric at the centre, and the growth of its mean length between opposite faces.
    std::vector<Judgement> fit(std::span<const CellBox> leaves, const FieldToFit& to) override {
        for_each_cell(leaves, [&](const CellBox& of) {
            const Point centre = of.box.centre();
            const Metric m = sample_at(to.field, centre);
            const Vector half = 0.5 * of.box.edges();
            const auto mean = [&](const Point& x) { return mean_length(sample_at(to.field, x)); };
            Vector growth;  // from the centre to the high faces
            for (Axis a = 0; a < 3; ++a) {
                const Vector step = half[a] * Vector::Unit(a);
                growth[a] = 0.5 * (mean(centre + step) - mean(centre - step)) / mean_length(m);
            }
            growth *= std::min(1.0, 0.9 / growth.lpNorm<1>());  // positive at all corners
            const Vector slope = growth.cwiseQuotient(half);
            this->metrics().set(of.cell, m);
            factors_[of.cell] = {1 - slope.dot(centre), slope.x(), slope.y(), slope.z()};
        });
        return {};
    }

    void arrays(LeafArrays& visitor) override { visitor("gradients.factors", factors_); }

private:
    using Factor = std::array<double, 4>;  // a, s
    static constexpr Factor constant{1, 0, 0, 0};
    static double factor_at(const Point& x, const Factor& f) {
        return f[0] + f[1] * x.x() + f[2] * x.y() + f[3] * x.z();
    }

    Box domain_;
    std::vector<Factor> factors_;  // of the leaves
};
