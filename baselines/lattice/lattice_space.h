#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "baselines/lattice/lattice_nodes.h"
#include "baselines/lattice/stencil.h"
#include "baselines/lattice/voxels.h"
#include "controlspace/error.h"
#include "controlspace/metric/intersection.h"
#include "controlspace/space/control_space_builder.h"
#include "gradation/regrade.h"
#include "space/shared_builder.h"
#include "space/state.h"
#include "trees/regradation/past_state.h"

namespace controlspace {

/// A field on a regular lattice of nodes, as SharedBuilder wants it: all that does not depend on
/// how their metrics are stored. The contract of a `Storage`:
///
///   Storage(const Lattice& lattice, const Metric& initial)
///   static double bytes_for(const Vector& nodes)  what a storage of so many nodes will allocate
///   reader()  -> r with r(i, j, k) -> const Metric& or Metric; cheap, one per call of `sample`
///   writer()  -> w with w.get(i, j, k) -> the same and w.set(i, j, k, metric)
///   void add_to(Footprint&) const                 its bytes
///   void prune(double delta)                      optional: joins nodes within δ of each other;
///                                                 never makes a metric larger; and with it
///   save_tiles(state), load_tiles(lattice, state) which nodes are joined
///
/// For `Stencil` see baselines/lattice/stencil.h.
template <class Storage, class Stencil>
class LatticeSpace {
public:
    /// Cells as fine as the options ask and allow. Throws InputError as choose_voxels does, and
    /// where later sources are to come to a grid that prunes what they would need.
    explicit LatticeSpace(const SpaceOptions& options)
        : LatticeSpace(options,
                       choose_voxels(options, Stencil::interpolation, [&](const Vector& nodes) {
                           const int copies = options.takes_later_sources ? 2 : 1;
                           return copies * Storage::bytes_for(nodes);
                       })) {}

    void sample(std::span<const Point> x, std::span<Metric> out) const {
        assert(x.size() == out.size());
        const auto read = storage_.reader();
        for (std::size_t i = 0; i < x.size(); ++i) out[i] = stencil_.value(x[i], read);
    }

    InsertionReport insert(std::span<const PointSource> sources) {
        InsertionReport report;
        with_writers([&](auto& field, auto& asked) {
            for (std::size_t i = 0; i < sources.size(); ++i) {
                require_valid(sources[i], i, domain());
                ++report.sources;
                if (insert_through(field, asked, sources[i]) == Insertion::inserted) {
                    ++report.inserted;
                }
            }
        });
        return report;
    }

    ControlNodes control_nodes(Neighbourhood neighbourhood) const {
        return {lattice(neighbourhood), metrics_of(storage_)};
    }

    void assign(std::span<const Metric> metrics) {
        require_one_each(metrics.size(), stencil_.lattice().size());
        set_field(metrics);
        if constexpr (joins_nodes) {
            if (prune_delta_ > 0) storage_.prune(prune_delta_);
        }
        asks_isotropic_ = std::all_of(metrics.begin(), metrics.end(), is_isotropic);
        asked_.reset();
        past_.reset();
    }

    GradationReport grade(const GradationOptions& options) {
        require_valid(options);
        GradationReport report;
        if (!takes_later_sources_) {
            std::vector<Metric> metrics = metrics_of(storage_);
            report = controlspace::grade(lattice(neighbourhood_of(options)), metrics, options);
            assign(metrics);
            return report;
        }
        if (may_regrade(past_, options) && asks_isotropic_ &&
            !are_many(lowered_.size(), stencil_.lattice().size())) {
            report = regrade();
        } else {
            std::vector<Metric> metrics = metrics_of(asked_ ? *asked_ : storage_);
            report = controlspace::grade(lattice(neighbourhood_of(options)), metrics, options);
            if (!asked_) asked_.emplace(storage_);
            set_field(metrics);
        }
        lowered_.clear();
        past_ = {options, report.largest_ratio_left};
        return report;
    }

    void save(StateWriter& state) const {
        state("grid.field", metrics_of(storage_));
        state("grid.asked", asked_ ? metrics_of(*asked_) : std::vector<Metric>());
        exchange_changes(*this, state);
        if constexpr (joins_nodes) storage_.save_tiles(state);
    }
    void load(const StateReader& state) {
        const auto metrics_named = [&](const char* name) {
            std::vector<Metric> metrics;
            state(name, metrics);
            require_metrics(state, name, metrics);
            return metrics;
        };
        const auto fits = [&](const std::vector<Metric>& metrics) {
            return metrics.size() == stencil_.lattice().size();
        };
        constexpr auto misfit = "has another number of nodes than this grid";
        const std::vector<Metric> field = metrics_named("grid.field");
        state.require(fits(field), "grid.field", misfit);
        set_field(field);
        asked_.reset();
        if (const std::vector<Metric> asked = metrics_named("grid.asked"); !asked.empty()) {
            state.require(fits(asked), "grid.asked", misfit);
            asked_.emplace(storage_);
            set_metrics(*asked_, asked);
        }
        exchange_changes(*this, state);
        require_below(state, "grid.lowered", lowered_, stencil_.lattice().size());
        if constexpr (joins_nodes) storage_.load_tiles(stencil_.lattice(), state);
    }

    const Box& domain() const { return stencil_.domain(); }
    Box cell_at(const Point& x) const { return stencil_.cell_at(x); }

    Footprint footprint() const {
        Footprint footprint;
        footprint.elements = static_cast<std::size_t>(stencil_.cells().prod());
        footprint.control_nodes = stencil_.lattice().size();
        footprint.depth = 1;
        footprint.remark = remark_;
        storage_.add_to(footprint);
        if (asked_) {
            Footprint beside;
            asked_->add_to(beside);
            footprint.bytes_auxiliary += beside.bytes_total();
        }
        return footprint;
    }

private:
    static constexpr bool joins_nodes = requires(Storage & storage) { storage.prune(0.0); };

    LatticeSpace(const SpaceOptions& options, Voxels voxels)
        : tolerance_(options.tolerance),
          takes_later_sources_(options.takes_later_sources),
          prune_delta_(options.prune_delta),
          stencil_(options.domain, voxels.cells),
          storage_(stencil_.lattice(), Metric::isotropic(options.domain.half_diagonal())),
          remark_(std::move(voxels.remark)) {
        if (takes_later_sources_ && prune_delta_ > 0) {
            throw InputError("a grid that takes later sources cannot be pruned: set prune_delta 0");
        }
    }

    Lattice lattice(Neighbourhood neighbourhood) const {
        Lattice lattice = stencil_.lattice();
        lattice.neighbourhood = neighbourhood;
        return lattice;
    }

    std::vector<Metric> metrics_of(const Storage& storage) const {
        const auto read = storage.reader();
        std::vector<Metric> metrics;
        metrics.reserve(stencil_.lattice().size());
        for_each_node([&](auto i, auto j, auto k) { metrics.push_back(read(i, j, k)); });
        return metrics;
    }

    void set_field(std::span<const Metric> metrics) { set_metrics(storage_, metrics); }
    void set_metrics(Storage& storage, std::span<const Metric> metrics) {
        auto nodes = storage.writer();
        auto next = metrics.begin();
        for_each_node([&](auto i, auto j, auto k) { nodes.set(i, j, k, *next++); });
    }

    template <class Self, class State>
    static void exchange_changes(Self& self, State& state) {
        exchange_past(self.past_, state);
        state("grid.lowered", self.lowered_);
        state("grid.asks_isotropic", self.asks_isotropic_);
    }

    /// act(field, asked): writers to the field and to what sources ask for, which may be the same.
    template <class Act>
    auto with_writers(Act&& act) {
        auto field = storage_.writer();
        if (!asked_) return act(field, field);
        auto asked = asked_->writer();
        return act(field, asked);
    }

    template <class Writer>
    Insertion insert_through(Writer& field, Writer& asked, const PointSource& source) {
        const Metric held = stencil_.value(
            source.position,
            [&](auto i, auto j, auto k) -> decltype(auto) { return asked.get(i, j, k); });
        if (!calls_for_change(source.metric, held, tolerance_)) return Insertion::already_met;
        const auto lower = [&](Writer& nodes, auto i, auto j, auto k) {
            nodes.set(i, j, k, intersection(nodes.get(i, j, k), source.metric));
        };
        stencil_.for_each_node(source.position, [&](auto i, auto j, auto k) {
            lower(field, i, j, k);
            if (!asked_) return;
            lower(asked, i, j, k);
            lowered_.push_back(stencil_.lattice().index(i, j, k));
        });
        asks_isotropic_ = asks_isotropic_ && is_isotropic(source.metric);
        return Insertion::inserted;
    }

    GradationReport regrade() {
        LatticeNodes nodes(lattice(neighbourhood_of(past_->options)), asked_->reader(),
                           storage_.writer());
        Regradation regradation(nodes, past_->options.ratio);
        std::sort(lowered_.begin(), lowered_.end());
        lowered_.erase(std::unique(lowered_.begin(), lowered_.end()), lowered_.end());
        for (const NodeIndex node : lowered_) regradation.touch(node);
        return regradation.run(past_->largest_ratio_left);
    }

    /// x fastest, as Lattice numbers them.
    template <class Visit>
    void for_each_node(Visit&& visit) const {
        const Lattice lattice = stencil_.lattice();
        for (std::uint32_t k = 0; k < lattice.nodes[2]; ++k) {
            for (std::uint32_t j = 0; j < lattice.nodes[1]; ++j) {
                for (std::uint32_t i = 0; i < lattice.nodes[0]; ++i) visit(i, j, k);
            }
        }
    }

    double tolerance_;
    bool takes_later_sources_;
    double prune_delta_;
    Stencil stencil_;
    Storage storage_;
    std::string remark_;

    // Where sources may come after gradation: what they ask for, and what has changed since.
    std::optional<Storage> asked_;
    std::optional<PastGradation> past_;
    std::vector<NodeIndex> lowered_;
    bool asks_isotropic_ = true;
};

template <class Storage>
std::unique_ptr<ControlSpaceBuilder> make_lattice_space(const SpaceOptions& options,
                                                        Interpolation interpolation) {
    if (interpolation == Interpolation::nearest) {
        return std::make_unique<SharedBuilder<LatticeSpace<Storage, NearestStencil>>>(options);
    }
    return std::make_unique<SharedBuilder<LatticeSpace<Storage, TrilinearStencil>>>(options);
}

}  // namespace controlspace
