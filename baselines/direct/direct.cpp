#include "baselines/direct/direct.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <vector>

#include "cones/cone_field.h"
#include "controlspace/error.h"
#include "controlspace/metric/intersection.h"
#include "space/goal_field.h"
#include "space/shared_builder.h"
#include "space/state.h"

namespace controlspace {

namespace {

double require_ratio(double ratio) {
    if (!std::isfinite(ratio) || ratio < 1) {
        throw InputError(
            fmt::format("gradation ratio g_r is {}: give a finite value of at least 1", ratio));
    }
    return ratio;
}

class Direct {
public:
    explicit Direct(const SpaceOptions& options)
        : domain_(require_volume(options.domain)), ratio_(require_ratio(options.ratio)) {}

    Direct(const Direct& other)
        : domain_(other.domain_),
          ratio_(other.ratio_),
          sources_(other.sources_),
          continuous_(other.continuous_) {}

    void sample(std::span<const Point> x, std::span<Metric> out) const {
        const ConeField& cones = field();
        std::vector<Point> moved;
        const auto is_inside = [this](const Point& p) { return domain_.contains(p); };
        if (!std::all_of(x.begin(), x.end(), is_inside)) {
            moved.assign(x.begin(), x.end());
            for (Point& p : moved) p = p.cwiseMax(domain_.low).cwiseMin(domain_.high);
            x = moved;
        }
        cones.evaluate(x, out);
        if (!continuous_) return;
        std::vector<Metric> own(x.size());
        continuous_->sample(x, own);
        for (std::size_t i = 0; i < x.size(); ++i) out[i] = intersection(out[i], own[i]);
    }

    InsertionReport insert(std::span<const PointSource> sources) {
        // A source that is refused leaves those before it.
        for (std::size_t i = 0; i < sources.size(); ++i) append(sources[i], i);
        if (sources.size() > 1) {
            sources_.shrink_to_fit();
            field();
        }
        return {sources.size(), sources.size()};
    }

    ControlNodes control_nodes(Neighbourhood) const {
        ControlNodes nodes;
        NodeGraph graph;
        graph.first.assign(sources_.size() + 1, 0);
        for (const auto& [position, metric] : sources_) {
            graph.positions.push_back(position);
            nodes.metrics.push_back(metric);
        }
        nodes.graph = std::move(graph);
        return nodes;
    }

    GradationReport grade(const GradationOptions& options) {
        const double before = ratio_;
        ratio_ = require_ratio(options.ratio);
        if (ratio_ != before) built_ = false;
        field();
        return {};
    }

    AdaptationReport adapt(const AdaptationGoal& goal) {
        const GoalField wanted(goal, domain_);
        ratio_ = goal.ratio;
        sources_.assign(goal.sources.begin(), goal.sources.end());
        continuous_ = goal.continuous;
        built_ = false;
        AdaptationReport report;
        report.reached =
            wanted.largest_departure(domain_, [this](auto x, auto metrics) { sample(x, metrics); });
        report.met = report.reached <= goal.target;
        return report;
    }

    void save(StateWriter& state) const {
        if (continuous_) {
            throw InputError(
                "`direct` cannot be saved with a continuous field: save a structure that holds "
                "metrics");
        }
        std::vector<Point> positions;
        std::vector<Metric> metrics;
        for (const auto& [position, metric] : sources_) {
            positions.push_back(position);
            metrics.push_back(metric);
        }
        state("sources.positions", positions);
        state("sources.metrics", metrics);
        state("sources.ratio", ratio_);
    }

    void load(const StateReader& state) {
        std::vector<Point> positions;
        std::vector<Metric> metrics;
        double ratio = 1;
        state("sources.positions", positions);
        state("sources.metrics", metrics);
        state("sources.ratio", ratio);
        state.require(positions.size() == metrics.size(), "sources.metrics", "has another length");
        ratio_ = require_ratio(ratio);
        sources_.clear();
        for (std::size_t i = 0; i < positions.size(); ++i) append({positions[i], metrics[i]}, i);
        sources_.shrink_to_fit();
        built_ = false;
    }

    const Box& domain() const { return domain_; }
    Box cell_at(const Point&) const { return domain_; }

    Footprint footprint() const {
        const ConeField& cones = field();
        Footprint footprint;
        footprint.elements = 1;
        footprint.control_nodes = sources_.size();
        footprint.depth = 1;
        footprint.bytes_payload = cones.bytes_payload();
        footprint.bytes_topology = cones.bytes_topology();
        footprint.bytes_auxiliary = sources_.capacity() * sizeof(PointSource);
        footprint.remark = fmt::format("cone law of ratio {}; {} of {} sources can matter", ratio_,
                                       sources_.size() - cones.dropped(), sources_.size());
        return footprint;
    }

private:
    void append(const PointSource& source, std::size_t index) {
        require_valid(source, index, domain_);
        if (sources_.size() >= std::numeric_limits<std::uint32_t>::max() / 2) {
            throw InputError("sources kept as they are: give fewer than 2^31");
        }
        sources_.push_back(source);
        built_ = false;
    }

    // Readers may come here at once after a single insertion: one builds, the others wait.
    const ConeField& field() const {
        if (built_) return *field_;
        const std::lock_guard lock(building_);
        if (!built_) {
            field_.reset();
            // Isolated: a thread that waits for its part of the work must not take up another task
            // that reads, and comes here again.
            tbb::this_task_arena::isolate([this] {
                field_ = std::make_unique<ConeField>(sources_, ratio_,
                                                     Metric::isotropic(domain_.half_diagonal()));
            });
            built_ = true;
        }
        return *field_;
    }

    Box domain_;
    double ratio_;
    std::vector<PointSource> sources_;  ///< as inserted
    std::shared_ptr<const ControlSpace> continuous_;
    mutable std::mutex building_;
    mutable std::atomic<bool> built_ = false;
    mutable std::unique_ptr<ConeField> field_;  ///< of all sources, once built
};

}  // namespace

std::unique_ptr<ControlSpaceBuilder> make_direct(const SpaceOptions& options) {
    return std::make_unique<SharedBuilder<Direct>>(options);
}

std::vector<CatalogueEntry> direct_rows() {
    return {{.id = "direct",
             .description = "no structure: the sources, searched; exact everywhere",
             .construct = make_direct,
             .capabilities = {KeptSources()}}};
}

}  // namespace controlspace
