// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "baselines/rows.h"
#include "cones/cone_field.h"
#include "controlspace/space/sample_parallel.h"
#include "refuse.h"
#include "space/given_sources.h"
#include "space/goal_field.h"
#include "space/saved.h"
#include "space/shared_builder.h"
#include "space/state.h"
#include "space/until_late.h"

namespace controlspace {

namespace {

/// The sources as inserted.
class Sources {
public:
    explicit Sources(const SpaceOptions& options)
        : domain_(options.domain),
          ratio_(options.ratio),
          h_max_(options.h_max),
          intersection_(options.intersection),
          limit_(options.growth) {
        require_valid(options);
    }

    InsertionReport insert(std::span<const PointSource> sources) {
        search_.reset();
        // A source that is refused leaves those before it.
        std::size_t valid = 0;
        while (valid < sources.size() && is_valid(sources[valid], domain_)) ++valid;
        if (sources_.size() + valid > most) refuse_more();
        sources_.add(sources.first(valid));
        if (valid < sources.size()) require_valid(sources[valid], valid, domain_);
        return {sources.size(), sources.size()};
    }
    InsertionReport insert(const SourceColumns& sources) {
        require_valid(sources, domain_);
        search_.reset();
        if (sources_.size() + sources.size() > most) refuse_more();
        sources_.add(sources);
        return {sources.size(), sources.size()};
    }
    GradationReport grade(const GradationOptions& options) {
        require_valid(options);
        if (ratio_ != options.ratio) search_.reset();
        ratio_ = options.ratio;
        return {};
    }
    AdaptationReport adapt(const AdaptationGoal& goal);

    static std::unique_ptr<ControlSpace> finished(std::shared_ptr<const Sources> sources,
                                                  std::optional<Precision> precision);

    ControlNodes control_nodes(Neighbourhood) const {
        ControlNodes nodes;
        NodeGraph graph;
        graph.first.assign(sources_.size() + 1, 0);
        graph.positions = sources_.positions();
        nodes.metrics = sources_.metrics();
        for (const double h : sources_.lengths()) nodes.metrics.push_back(Metric::isotropic(h));
        nodes.graph = std::move(graph);
        return nodes;
    }

    void save(StateWriter& state) const {
        if (continuous_) {
            refuse(
                "`direct` cannot be saved with a continuous field: save a structure that holds "
                "metrics");
        }
        controlspace::save(state, "sources", sources_);
        state("sources.ratio", ratio_);
        state("sources.h_max", h_max_);
        state("sources.intersection", intersection_, IntersectionRule::in_turn);
    }
    void load(const StateReader& state) {
        const SourceColumns loaded = load_sources(state, "sources");
        state("sources.ratio", ratio_);
        state("sources.h_max", h_max_);
        state.require(is_length(h_max_), "sources.h_max", "is no length");
        state("sources.intersection", intersection_, IntersectionRule::in_turn);
        require_valid(GradationOptions{.ratio = ratio_});
        sources_ = {};
        insert(loaded);
    }

    const Box& domain() const { return domain_; }
    double ratio() const { return ratio_; }
    Metric largest() const { return largest_metric(domain_, h_max_); }
    const SourceColumns& all() const { return sources_; }
    const ControlSpace* continuous() const { return continuous_.get(); }

    /// The search among them, made once for all that is built.
    std::shared_ptr<const ConeField> search() const {
        constexpr double tolerance = 1e-3;  // of order-free intersections
        if (!search_) {
            search_ = std::make_shared<const ConeField>(
                sources_, ratio_, largest(),
                intersection_ == IntersectionRule::order_free ? tolerance : 0, intersection_);
        }
        return search_;
    }

private:
    [[noreturn]] static void refuse_more() {
        refuse("sources kept as they are: give fewer than 2^31");
    }

    static constexpr std::size_t most = std::numeric_limits<std::uint32_t>::max() / 2;

    Box domain_;
    double ratio_;
    double h_max_;
    IntersectionRule intersection_;
    GrowthLimit limit_;
    SourceColumns sources_;
    std::shared_ptr<const ControlSpace> continuous_;
    mutable std::shared_ptr<const ConeField> search_;  ///< none since the last change
};

/// The search among them.
class Direct final : public ControlSpace, public HasControlNodes, public Saved {
public:
    explicit Direct(std::shared_ptr<const Sources> sources)
        : sources_(std::move(sources)), search_(sources_->search()), cones_(*search_) {}

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        std::vector<Point> moved;
        x = inside(x, moved);
        std::vector<Metric> own;
        if (sources_->continuous() != nullptr) {
            own.resize(x.size());
            sources_->continuous()->sample(x, own);
        }
        cones_.evaluate(x, out, own);
    }
    void sample_lengths(std::span<const Point> x, std::span<double> out) const override {
        if (sources_->continuous() != nullptr || !cones_.is_isotropic()) {
            return ControlSpace::sample_lengths(x, out);
        }
        std::vector<Point> moved;
        cones_.evaluate_lengths(inside(x, moved), out);
    }
    Box domain() const override { return sources_->domain(); }
    std::optional<Box> cell_at(const Point&) const override { return domain(); }

    Footprint footprint() const override {
        const std::size_t count = sources_->all().size();
        Footprint footprint;
        footprint.cells = 1;
        footprint.control_nodes = count;
        footprint.bytes_payload = cones_.bytes_payload();
        footprint.bytes_topology = cones_.bytes_topology();
        footprint.bytes_auxiliary = sources_->all().bytes();
        footprint.remark = fmt::format("cone law of ratio {}; {} of {} sources can matter",
                                       sources_->ratio(), count - cones_.dropped(), count);
        return footprint;
    }
    ControlNodes control_nodes(Neighbourhood neighbourhood) const override {
        return sources_->control_nodes(neighbourhood);
    }
    void save(StateWriter& state) const override { sources_->save(state); }

private:
    /// The nearest places in the domain, in `moved` where they are others.
    std::span<const Point> inside(std::span<const Point> x, std::vector<Point>& moved) const {
        const Box& box = sources_->domain();
        if (std::ranges::all_of(x, [&](const Point& p) { return box.contains(p); })) return x;
        moved.assign(x.begin(), x.end());
        for (Point& p : moved) p = nearest_in(box, p);
        return moved;
    }

    std::shared_ptr<const Sources> sources_;
    std::shared_ptr<const ConeField> search_;
    const ConeField& cones_;
};

std::unique_ptr<ControlSpace> Sources::finished(std::shared_ptr<const Sources> sources,
                                                std::optional<Precision> precision) {
    if (precision) refuse_precision();
    return std::make_unique<Direct>(std::move(sources));
}

AdaptationReport Sources::adapt(const AdaptationGoal& goal) {
    search_.reset();
    h_max_ = std::min(h_max_, goal.h_max);
    AdaptationGoal bounded = goal;
    bounded.h_max = h_max_;
    const GoalField wanted(bounded, domain_);
    ratio_ = goal.ratio;
    intersection_ = goal.intersection;
    sources_ = columns_of(goal.sources);
    continuous_ = goal.continuous;
    AdaptationReport report;
    try {
        require_in_time(limit_);
        const Direct direct(std::make_shared<Sources>(*this));
        const UntilLate in_time(direct, limit_);
        report.reached = wanted.largest_departure(
            domain_, [&](auto x, auto metrics) { sample_parallel(in_time, x, metrics); }, limit_);
        report.met = report.reached <= goal.target;
    } catch (const GrowthStopped& stopped) {
        // It is complete; how near it comes was not found out.
        report.reached = std::numeric_limits<double>::infinity();
        report.stop = stopped.stop();
        report.shortfall = stopped.what();
    }
    return report;
}

}  // namespace

std::vector<CatalogueEntry> direct_rows() {
    return {{.id = "direct",
             .description = "no structure: the sources, searched; exact everywhere",
             .construct = [](const SpaceOptions& options) -> std::unique_ptr<ControlSpaceBuilder> {
                 return std::make_unique<SharedBuilder<Sources>>(options);
             },
             .capabilities = {KeptSources()}}};
}

}  // namespace controlspace
