// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <ranges>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "controlspace/error.h"
#include "controlspace/space/control_nodes.h"
#include "controlspace/space/control_space.h"
#include "controlspace/space/control_space_builder.h"
#include "space/adapt_for_precision.h"
#include "space/given_sources.h"
#include "space/plain_cursor.h"
#include "space/saved.h"

namespace controlspace {

/// A finished structure: `Data` that is only read, shared with its builder.
template <class Data>
class SharedSpace final : public ControlSpace, public HasControlNodes, public Saved {
public:
    explicit SharedSpace(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        data_->sample(x, out);
    }
    void sample_lengths(std::span<const Point> x, std::span<double> out) const override {
        if constexpr (requires { data_->sample_lengths(x, out); }) {
            if (has_lengths()) return data_->sample_lengths(x, out);
        }
        ControlSpace::sample_lengths(x, out);
    }
    Metric metric_at(const Point& x) const override {
        if constexpr (requires { data_->length_at(x); }) {
            if (has_lengths()) return Metric::isotropic(data_->length_at(x));
        }
        if constexpr (requires { data_->metric_at(x); }) return data_->metric_at(x);
        return ControlSpace::metric_at(x);
    }
    double length_at(const Point& x) const override {
        if constexpr (requires { data_->length_at(x); }) {
            if (has_lengths()) return data_->length_at(x);
        }
        return ControlSpace::length_at(x);
    }
    std::unique_ptr<Cursor> cursor() const override {
        if constexpr (requires { data_->length_cursor(); }) {
            if (has_lengths()) {
                if (auto cursor = data_->length_cursor()) return cursor;
            }
        }
        return std::make_unique<PlainCursor<SharedSpace>>(*this);
    }
    Box domain() const override { return data_->domain(); }
    Footprint footprint() const override {
        Footprint footprint = data_->footprint();
        footprint.bytes_auxiliary += given().bytes();
        return footprint;
    }
    std::optional<Box> cell_at(const Point& x) const override { return data_->cell_at(x); }
    ControlNodes control_nodes(Neighbourhood neighbourhood) const override {
        return data_->control_nodes(neighbourhood);
    }
    double largest_gradation(Neighbourhood neighbourhood, GradationLaw law) const override {
        if constexpr (requires { data_->largest_gradation(neighbourhood, law); }) {
            return data_->largest_gradation(neighbourhood, law);
        }
        return HasControlNodes::largest_gradation(neighbourhood, law);
    }
    void save(StateWriter& state) const override { data_->save(state); }

private:
    enum class Known : std::uint8_t { no, lengths, tensors };

    // Found when it is first asked for: finding it reads all metrics.
    bool has_lengths() const {
        Known known = known_.load(std::memory_order_relaxed);
        if (known == Known::no) {
            known = data_->has_lengths() ? Known::lengths : Known::tensors;
            known_.store(known, std::memory_order_relaxed);
        }
        return known == Known::lengths;
    }

    std::shared_ptr<const Data> data_;
    mutable std::atomic<Known> known_ = Known::no;
};

/// Data whose control nodes carry metrics: their builder is a NodeBuilder.
template <class Data>
concept HoldsMetrics = requires(Data& data, std::span<const Metric> metrics) {
    data.assign(metrics);
};

/// A builder around `Data`, which can be copied, read and changed: sample, domain, footprint,
/// cell_at, control_nodes, save, for single places metric_at, and, with has_lengths(),
/// sample_lengths, length_at and length_cursor; insert(sources), grade(options), adapt, load; for a
/// NodeBuilder order() of its interpolation, assign, options and grade(NodeGradation), and it may
/// leave out adapt. With
/// pack(precision) it has compact forms; finish() is called before it is built. With
/// finished(shared data, precision) it is built in other forms than SharedSpace.
///
/// What it builds shares the data, which are copied before the next change as long as they are
/// shared.
///
/// With SpaceOptions::takes_later_sources, gradation after anything but a single insertion makes
/// the data anew from what was given, with one insertion of all sources. Data without options()
/// keep all sources themselves.
template <class Data>
class SharedBuilder final
    : public std::conditional_t<HoldsMetrics<Data>, NodeBuilder, ControlSpaceBuilder>,
      public SavedBuilder {
    static constexpr bool has_nodes = HoldsMetrics<Data>;
    using Base = std::conditional_t<has_nodes, NodeBuilder, ControlSpaceBuilder>;
    using Saved::given_;

public:
    template <class... Arguments>
    explicit SharedBuilder(const Arguments&... arguments)
        : make_([arguments...] { return std::make_shared<Data>(arguments...); }), data_(make_()) {
        if (has_nodes || takes_later()) given_.sources.emplace();
    }

    using ControlSpaceBuilder::insert;
    InsertionReport insert(std::span<const PointSource> sources) override {
        if (has_nodes && !knows_sources()) require_alike_growth(sources);
        begin_insertion();
        const auto is_refused = [&](const PointSource& s) { return !is_valid(s, domain()); };
        try {
            const InsertionReport report = edit().insert(sources);
            keep(sources);
            return report;
        } catch (...) {
            keep(std::span(sources.begin(), std::ranges::find_if(sources, is_refused)));
            throw;
        }
    }
    InsertionReport insert(const SourceColumns& sources) override {
        if constexpr (requires(Data & data) { data.insert(sources); }) {
            return edit().insert(sources);
        } else {
            if (!knows_sources()) return Base::insert(sources);
            require_valid(sources, domain());
            begin_insertion();
            given_.sources->add(sources);
            note_growth(sources.growths().values());
            InsertionReport report;
            for_each_part(
                sources, [&](std::span<const PointSource> part) { report += edit().insert(part); });
            return report;
        }
    }
    GradationReport grade(const GradationOptions& options) override {
        const bool builds_again = takes_later() && !given_.is_inserted;
        if (given_.goal ? graded_ && graded_->ratio == options.ratio : graded_ == options)
            return {};
        if (given_.goal) {
            adapt_again(options);
            graded_ = options;
            return {};
        }
        const auto grade = [&](const auto& wanted, bool is_settled) {
            const auto data = builds_again ? data_from_given() : nullptr;
            const GradationReport report = (data ? *data : edit()).grade(wanted);
            if (data) data_ = data;
            given_.is_inserted = false;
            graded_.reset();
            if (is_settled) graded_ = options;
            return report;
        };
        if constexpr (has_nodes) {
            if (!knows_sources() && this->grows_apart()) {
                throw InputError(
                    "it holds sources with gradation ratios of their own, which are not known any "
                    "more: adapt it anew, or insert and grade them in a new one");
            }
            const NodeGradation gradation(options, knows_sources() ? &*given_.sources : nullptr,
                                          data_->options());
            return grade(gradation, gradation.field || takes_later());
        } else {
            return grade(options, takes_later());
        }
    }
    AdaptationReport adapt(const AdaptationGoal& goal) override {
        given_ = {};
        graded_.reset();
        if constexpr (has_nodes) {
            this->set_grows_apart(false);
            note_growth(growths(goal.sources));
        }
        AdaptationReport report = adapt_data(goal);
        given_ = {.is_inserted = false};
        if (!takes_later()) return report;
        given_.sources = columns_of(goal.sources);
        given_.places.assign(goal.places.begin(), goal.places.end());
        given_.goal = goal;
        given_.goal->sources = {};
        given_.goal->places = {};
        graded_ = GradationOptions{.ratio = goal.ratio};
        return report;
    }
    std::unique_ptr<ControlSpace> build(const BuildOptions& options) override {
        constexpr bool has_forms = requires { Data::finished(data_, options.precision); };
        if (options.precision && !has_forms) return pack(*options.precision);
        if constexpr (requires(Data & data) { data.finish(); }) {
            if (!data_->is_finished()) edit().finish();
        }
        if constexpr (has_forms) {
            return described(Data::finished(data_, options.precision), options.precision);
        } else {
            return described(std::make_unique<SharedSpace<Data>>(data_));
        }
    }
    Box domain() const override { return data_->domain(); }

    ControlNodes control_nodes(Neighbourhood neighbourhood) const {
        return data_->control_nodes(neighbourhood);
    }
    void assign(std::span<const Metric> metrics) {
        if constexpr (has_nodes) {
            edit().assign(metrics);
            this->set_grows_apart(false);
            begin_with_field();
        }
    }

    void save(StateWriter& state) const override { data_->save(state); }
    void load(const StateReader& state) override {
        edit().load(state);
        given_ = load_given(state);
        graded_.reset();
        if (!takes_later() || state.has("compact.precision")) return;
        if (!given_.sources) begin_with_field();
        if (given_.base) make_()->load(StateReader(*given_.base, "its base"));
    }

private:
    bool takes_later() const {
        if constexpr (requires { data_->options(); }) return data_->options().takes_later_sources;
        return false;
    }
    // Whether the field is that of the sources given.
    bool knows_sources() const { return given_.sources && !given_.base; }
    void begin_insertion() {
        graded_.reset();
        if (given_.sources && !given_.sources->empty()) given_.is_inserted = false;
    }
    // What they request counts in gradation, whether they change nodes or not.
    void keep(std::span<const PointSource> sources) {
        if (given_.sources) given_.sources->add(sources);
        note_growth(growths(sources));
    }
    // The field as it stands is what later sources are inserted into, each time.
    void begin_with_field() {
        given_ = {};
        graded_.reset();
        if (!takes_later()) return;
        StateWriter state;
        data_->save(state);
        given_.sources.emplace();
        given_.base = std::make_shared<const std::string>(state.bytes());
    }
    // With all sources inserted at once.
    std::shared_ptr<Data> data_from_given() const {
        std::shared_ptr<Data> data = make_();
        if (given_.base) data->load(StateReader(*given_.base, "its base"));
        for_each_part(*given_.sources,
                      [&](std::span<const PointSource> part) { data->insert(part); });
        return data;
    }
    // To the same goal and all sources, with another ratio.
    void adapt_again(const GradationOptions& options) {
        require_valid(options);
        const std::vector<PointSource> all = given_.sources->all();
        AdaptationGoal goal = given_.goal_of(all);
        goal.ratio = options.ratio;
        const std::shared_ptr<Data> before = std::exchange(data_, make_());
        try {
            adapt_data(goal);
        } catch (...) {
            data_ = before;
            throw;
        }
    }
    AdaptationReport adapt_data(const AdaptationGoal& goal) {
        const auto adapt = [this](const AdaptationGoal& g) {
            if constexpr (requires(Data & data) { data.adapt(g); }) {
                return edit().adapt(g);
            } else {
                return Base::adapt(g);
            }
        };
        const AdaptationGoal wanted = bounded(goal);
        if constexpr (has_nodes) {
            const double longest = largest_metric(domain(), wanted.h_max).xx;
            AdaptationReport report = adapt_for_precision(
                wanted, longest, data_->order(), adapt,
                [this] { return data_->control_nodes(Neighbourhood::faces).metrics; });
            if (this->recipe() && !takes_later()) {
                Recipe recipe = *this->recipe();
                recipe.options.voxel = data_->options().voxel;  // a grid may have chosen it
                this->set_recipe(std::move(recipe));
            }
            return report;
        } else {
            return adapt(wanted);
        }
    }
    AdaptationGoal bounded(AdaptationGoal goal) const {
        if constexpr (requires { data_->options(); }) {
            goal.h_max = std::min(goal.h_max, data_->options().h_max);
        }
        return goal;
    }
    static auto growths(std::span<const PointSource> sources) {
        return sources | std::views::transform(&PointSource::growth);
    }
    void note_growth(const auto& growths) {
        if constexpr (has_nodes) {
            if (std::ranges::any_of(growths, [](double growth) { return growth != 0; })) {
                this->set_grows_apart(true);
            }
        }
    }

    template <class Space>
    std::unique_ptr<Space> described(std::unique_ptr<Space> space,
                                     std::optional<Precision> precision = {}) const {
        auto& saved = dynamic_cast<Saved&>(*space);
        if (this->recipe()) {
            Recipe recipe = *this->recipe();
            recipe.precision = precision;
            saved.set_recipe(std::move(recipe));
        }
        if (precision) return space;  // it is only read
        saved.set_grows_apart(this->grows_apart());
        if (takes_later()) saved.set_given(given_);
        return space;
    }

    Data& edit() {
        if (data_.use_count() > 1) {
            data_ = std::make_shared<Data>(*data_);
        } else {
            // What the last of the spaces that shared them has read, perhaps in another thread, is
            // behind us.
            std::atomic_thread_fence(std::memory_order_acquire);
        }
        return *data_;
    }

    std::unique_ptr<ControlSpace> pack(Precision precision) {
        if constexpr (requires(const Data& data) { data.pack(precision); }) {
            return described(data_->pack(precision), precision);
        } else {
            refuse_precision();
        }
    }

    std::function<std::shared_ptr<Data>()> make_;  // new ones
    std::shared_ptr<Data> data_;
    std::optional<GradationOptions> graded_;  // by the last change, so that it makes no other
};

}  // namespace controlspace
