// SPDX-License-Identifier: Apache-2.0
// A structure of one's own that is neither a tree nor a grid: a list of all sources, each evaluated
// for every point. Its row makes it run wherever the catalogue's structures do.
#pragma once

#include <controlspace/error.h>
#include <controlspace/metric/intersection.h>
#include <controlspace/sources/cone.h>
#include <controlspace/space/catalogue.h>

#include <memory>
#include <vector>

using namespace controlspace;

/// What is read: the intersection of all sources' cones, M (1 + (g_r - 1) |x - p|_M) (paper §5.2).
class BruteForce final : public ControlSpace {
public:
    BruteForce(const Box& domain, double ratio, std::vector<PointSource> sources)
        : domain_(domain), ratio_(ratio), sources_(std::move(sources)) {}

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        for (std::size_t i = 0; i < x.size(); ++i) {
            const Point p = x[i].cwiseMax(domain_.low).cwiseMin(domain_.high);
            out[i] = largest_metric(domain_);
            for (const PointSource& source : sources_) {
                out[i] = intersection(out[i], cone_factor(source, ratio_, p) * source.metric);
            }
        }
    }
    Box domain() const override { return domain_; }
    Footprint footprint() const override {
        Footprint footprint;
        footprint.control_nodes = sources_.size();
        footprint.bytes_payload = sources_.capacity() * sizeof(PointSource);
        return footprint;
    }

private:
    Box domain_;
    double ratio_;
    std::vector<PointSource> sources_;
};

/// What makes it. The cones are graded already: `grade` only sets their ratio.
class BruteForceBuilder final : public ControlSpaceBuilder {
public:
    explicit BruteForceBuilder(const SpaceOptions& options)
        : domain_(options.domain), ratio_(options.ratio) {}

    InsertionReport insert(std::span<const PointSource> sources) override {
        for (std::size_t i = 0; i < sources.size(); ++i) {
            require_valid(sources[i], i, domain_);
            sources_.push_back(sources[i]);
        }
        return {sources.size(), sources.size()};
    }
    GradationReport grade(const GradationOptions& options) override {
        require_valid(options);
        ratio_ = options.ratio;
        return {};
    }
    AdaptationReport adapt(const AdaptationGoal& goal) override {
        if (goal.continuous) throw InputError("brute-force holds sources alone");
        sources_.assign(goal.sources.begin(), goal.sources.end());
        ratio_ = goal.ratio;
        return {.reached = 0, .met = true, .shortfall = {}};
    }
    std::unique_ptr<ControlSpace> build(const BuildOptions&) override {
        return std::make_unique<BruteForce>(domain_, ratio_, sources_);
    }
    Box domain() const override { return domain_; }

private:
    Box domain_;
    double ratio_;
    std::vector<PointSource> sources_;
};

inline CatalogueEntry brute_force_row() {
    CatalogueEntry row;
    row.id = "brute-force";
    row.description = "no structure: all sources are evaluated for every point";
    row.construct = [](const SpaceOptions& options) -> std::unique_ptr<ControlSpaceBuilder> {
        return std::make_unique<BruteForceBuilder>(options);
    };
    row.capabilities = {KeptSources{}};
    return row;
}
