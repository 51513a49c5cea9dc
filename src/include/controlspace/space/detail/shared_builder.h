// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>

#include "controlspace/error.h"
#include "controlspace/space/control_nodes.h"
#include "controlspace/space/control_space.h"
#include "controlspace/space/control_space_builder.h"
#include "controlspace/space/detail/adapt_for_precision.h"
#include "controlspace/space/detail/given_sources.h"
#include "controlspace/space/detail/plain_cursor.h"
#include "controlspace/space/detail/saved.h"

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
            if (has_lengths()) return data_->length_cursor();
        }
        return std::make_unique<PlainCursor<SharedSpace>>(*this);
    }
    Box domain() const override { return data_->domain(); }
    Footprint footprint() const override {
        Footprint footprint = data_->footprint();
        if (given()) footprint.bytes_auxiliary += given()->bytes();
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
/// NodeBuilder the order of its interpolation, assign, options and grade(NodeGradation), and it may
/// leave out adapt. With
/// pack(precision) it has compact forms; finish() is called before it is built. With
/// finished(shared data, precision) it is built in other forms than SharedSpace.
///
/// What it builds shares the data, which are copied before the next change as long as they are
/// shared.
template <class Data>
class SharedBuilder final
    : public std::conditional_t<HoldsMetrics<Data>, NodeBuilder, ControlSpaceBuilder>,
      public SavedBuilder {
    static constexpr bool has_nodes = HoldsMetrics<Data>;
    using Base = std::conditional_t<has_nodes, NodeBuilder, ControlSpaceBuilder>;

public:
    template <class... Arguments>
    explicit SharedBuilder(const Arguments&... arguments)
        : data_(std::make_shared<Data>(arguments...)) {
        if constexpr (has_nodes) this->set_given(SourceColumns());
    }

    using ControlSpaceBuilder::insert;
    InsertionReport insert(std::span<const PointSource> sources) override {
        if constexpr (has_nodes) {
            const InsertionReport report = insert_and_keep(sources);
            note_growth(sources);
            return report;
        }
        return edit().insert(sources);
    }
    InsertionReport insert(const SourceColumns& sources) override {
        if constexpr (requires(Data & data) { data.insert(sources); }) {
            return edit().insert(sources);
        } else if constexpr (has_nodes) {
            if (!this->given()) return Base::insert(sources);
            require_valid(sources, domain());
            graded_by_sources_.reset();
            this->add_given(sources);
            const auto grows = [](double growth) { return growth != 0; };
            if (std::ranges::any_of(sources.growths().values(), grows)) this->set_grows_apart(true);
            InsertionReport report;
            for_each_part(
                sources, [&](std::span<const PointSource> part) { report += edit().insert(part); });
            return report;
        } else {
            return Base::insert(sources);
        }
    }
    GradationReport grade(const GradationOptions& options) override {
        if constexpr (has_nodes) {
            if (graded_by_sources_ == options) return {.visits = 0};
            if (!this->given() && this->grows_apart()) {
                throw InputError(
                    "it holds sources with gradation ratios of their own, which are not known any "
                    "more: adapt it anew, or insert and grade them in a new one");
            }
            const NodeGradation gradation(options, this->given() ? &*this->given() : nullptr,
                                          data_->options());
            const GradationReport report = edit().grade(gradation);
            graded_by_sources_.reset();
            if (gradation.field) graded_by_sources_ = options;
            return report;
        } else {
            return edit().grade(options);
        }
    }
    AdaptationReport adapt(const AdaptationGoal& goal) override {
        forget_given();
        if constexpr (has_nodes) {
            this->set_grows_apart(false);
            note_growth(goal.sources);
        }
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
                wanted, longest, Data::order, adapt,
                [this] { return data_->control_nodes(Neighbourhood::faces).metrics; });
            if (this->recipe()) {
                Recipe recipe = *this->recipe();
                recipe.options.voxel = data_->options().voxel;  // a grid may have chosen it
                this->set_recipe(std::move(recipe));
            }
            return report;
        } else {
            return adapt(wanted);
        }
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
            forget_given();
            this->set_grows_apart(false);
        }
    }

    void save(StateWriter& state) const override { data_->save(state); }
    void load(const StateReader& state) override { edit().load(state); }

private:
    // What they request counts in gradation, whether they change nodes or not.
    InsertionReport insert_and_keep(std::span<const PointSource> sources) {
        if (!this->given()) require_alike_growth(sources);
        graded_by_sources_.reset();
        const auto is_refused = [&](const PointSource& s) { return !is_valid(s, domain()); };
        try {
            const InsertionReport report = edit().insert(sources);
            this->add_given(sources);
            return report;
        } catch (...) {
            const auto first = std::ranges::find_if(sources, is_refused);
            this->add_given(std::span(sources.begin(), first));
            throw;
        }
    }
    AdaptationGoal bounded(AdaptationGoal goal) const {
        if constexpr (requires { data_->options(); }) {
            goal.h_max = std::min(goal.h_max, data_->options().h_max);
        }
        return goal;
    }
    void note_growth(std::span<const PointSource> sources) {
        const auto grows = [](const PointSource& s) { return s.growth != 0; };
        if (std::ranges::any_of(sources, grows)) this->set_grows_apart(true);
    }
    // The field is no longer that of sources inserted.
    void forget_given() {
        this->set_given({});
        graded_by_sources_.reset();
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
        if constexpr (has_nodes) {
            if (data_->options().takes_later_sources) saved.set_given(this->given());
        }
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

    std::shared_ptr<Data> data_;
    std::optional<GradationOptions> graded_by_sources_;  // since the last change
};

}  // namespace controlspace
