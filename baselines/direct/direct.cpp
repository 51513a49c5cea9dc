#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "baselines/rows.h"
#include "cones/cone_field.h"
#include "controlspace/space/detail/goal_field.h"
#include "controlspace/space/detail/own_growths.h"
#include "controlspace/space/detail/saved.h"
#include "controlspace/space/detail/shared_builder.h"
#include "controlspace/space/detail/state.h"
#include "refuse.h"

namespace controlspace {

namespace {

/// The sources as inserted.
class Sources {
public:
    explicit Sources(const SpaceOptions& options)
        : domain_(options.domain),
          ratio_(options.ratio),
          h_max_(options.h_max),
          intersection_(options.intersection) {
        require_valid(options);
    }

    InsertionReport insert(std::span<const PointSource> sources) {
        if (sources.size() > 1) sources_.reserve(sources_.size() + sources.size());
        // A source that is refused leaves those before it.
        for (std::size_t i = 0; i < sources.size(); ++i) append(sources[i], i);
        return {sources.size(), sources.size()};
    }
    GradationReport grade(const GradationOptions& options) {
        require_valid(options);
        if (ratio_ != options.ratio) search_.reset();
        ratio_ = options.ratio;
        return {};
    }
    AdaptationReport adapt(const AdaptationGoal& goal);

    static std::unique_ptr<ControlSpace> finished(std::shared_ptr<const Sources> sources);

    ControlNodes control_nodes(Neighbourhood) const {
        ControlNodes nodes;
        NodeGraph graph;
        graph.first.assign(sources_.size() + 1, 0);
        for (const PointSource& source : sources_) {
            graph.positions.push_back(source.position);
            nodes.metrics.push_back(source.metric);
        }
        nodes.graph = std::move(graph);
        return nodes;
    }

    void save(StateWriter& state) const {
        if (continuous_) {
            refuse(
                "`direct` cannot be saved with a continuous field: save a structure that holds "
                "metrics");
        }
        const ControlNodes nodes = control_nodes(Neighbourhood::faces);
        state("sources.positions", positions(nodes.graph));
        state("sources.metrics", nodes.metrics);
        state("sources.ratio", ratio_);
        state("sources.h_max", h_max_);
        state("sources.intersection", intersection_, IntersectionRule::in_turn);
        OwnGrowths growths;
        for (std::size_t i = 0; i < sources_.size(); ++i) growths.add(i, sources_[i].growth);
        growths.save(state, "sources.growths");
    }
    void load(const StateReader& state) {
        std::vector<Point> positions;
        std::vector<Metric> metrics;
        state("sources.positions", positions);
        state("sources.metrics", metrics);
        state("sources.ratio", ratio_);
        state("sources.h_max", h_max_);
        state.require(is_length(h_max_), "sources.h_max", "is no length");
        state("sources.intersection", intersection_, IntersectionRule::in_turn);
        state.require(positions.size() == metrics.size(), "sources.metrics", "has another length");
        require_valid(GradationOptions{.ratio = ratio_});
        OwnGrowths growths;
        growths.load(state, "sources.growths", positions.size());
        search_.reset();
        sources_.clear();
        sources_.reserve(positions.size());
        for (std::size_t i = 0; i < positions.size(); ++i) {
            append({positions[i], metrics[i], growths[i]}, i);
        }
    }

    const Box& domain() const { return domain_; }
    double ratio() const { return ratio_; }
    Metric largest() const { return largest_metric(domain_, h_max_); }
    const std::vector<PointSource>& all() const { return sources_; }
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
    void append(const PointSource& source, std::size_t index) {
        search_.reset();
        require_valid(source, index, domain_);
        if (sources_.size() >= std::numeric_limits<std::uint32_t>::max() / 2) {
            refuse("sources kept as they are: give fewer than 2^31");
        }
        sources_.push_back(source);
    }

    Box domain_;
    double ratio_;
    double h_max_;
    IntersectionRule intersection_;
    std::vector<PointSource> sources_;
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
        footprint.bytes_auxiliary = sources_->all().capacity() * sizeof(PointSource);
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

std::unique_ptr<ControlSpace> Sources::finished(std::shared_ptr<const Sources> sources) {
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
    sources_.assign(goal.sources.begin(), goal.sources.end());
    continuous_ = goal.continuous;
    const Direct direct(std::make_shared<Sources>(*this));
    AdaptationReport report;
    report.reached =
        wanted.largest_departure(domain_, [&](auto x, auto metrics) { direct.sample(x, metrics); });
    report.met = report.reached <= goal.target;
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
