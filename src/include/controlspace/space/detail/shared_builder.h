#pragma once

#include <atomic>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>

#include "controlspace/error.h"
#include "controlspace/space/control_nodes.h"
#include "controlspace/space/control_space.h"
#include "controlspace/space/control_space_builder.h"
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
    Box domain() const override { return data_->domain(); }
    Footprint footprint() const override { return data_->footprint(); }
    std::optional<Box> cell_at(const Point& x) const override { return data_->cell_at(x); }
    ControlNodes control_nodes(Neighbourhood neighbourhood) const override {
        return data_->control_nodes(neighbourhood);
    }
    void save(StateWriter& state) const override { data_->save(state); }

private:
    std::shared_ptr<const Data> data_;
};

/// A builder around `Data`, which can be copied, read and changed: sample, domain, footprint,
/// cell_at, control_nodes, save; insert(sources), grade, adapt, load; for a NodeBuilder assign,
/// which then may leave out grade and adapt. With pack(precision) it has compact forms; finish() is
/// called before it is built. With finished(shared data) it is built in another form than
/// SharedSpace.
///
/// What it builds shares the data, which are copied before the next change as long as they are
/// shared.
template <class Data>
    class SharedBuilder final
    : public std::conditional_t < requires(Data& data, std::span<const Metric> metrics) {
    data.assign(metrics);
}, NodeBuilder, ControlSpaceBuilder >, public SavedBuilder {
    static constexpr bool has_nodes = requires(Data & data, std::span<const Metric> metrics) {
        data.assign(metrics);
    };
    using Base = std::conditional_t<has_nodes, NodeBuilder, ControlSpaceBuilder>;

public:
    template <class... Arguments>
    explicit SharedBuilder(const Arguments&... arguments)
        : data_(std::make_shared<Data>(arguments...)) {}

    using ControlSpaceBuilder::insert;
    InsertionReport insert(std::span<const PointSource> sources) override {
        return edit().insert(sources);
    }
    GradationReport grade(const GradationOptions& options) override {
        if constexpr (requires(Data & data) { data.grade(options); }) {
            return edit().grade(options);
        } else {
            return Base::grade(options);
        }
    }
    AdaptationReport adapt(const AdaptationGoal& goal) override {
        if constexpr (requires(Data & data) { data.adapt(goal); }) {
            return edit().adapt(goal);
        } else {
            return Base::adapt(goal);
        }
    }
    std::unique_ptr<ControlSpace> build(const BuildOptions& options) override {
        if (options.precision) return pack(*options.precision);
        if constexpr (requires(Data & data) { data.finish(); }) {
            if (!data_->is_finished()) edit().finish();
        }
        if constexpr (requires { Data::finished(data_); }) {
            auto space = Data::finished(data_);
            dynamic_cast<Saved&>(*space).set_recipe(this->recipe());
            return space;
        } else {
            auto space = std::make_unique<SharedSpace<Data>>(data_);
            space->set_recipe(this->recipe());
            return space;
        }
    }
    Box domain() const override { return data_->domain(); }

    ControlNodes control_nodes(Neighbourhood neighbourhood) const {
        return data_->control_nodes(neighbourhood);
    }
    void assign(std::span<const Metric> metrics) {
        if constexpr (has_nodes) {
            edit().assign(metrics);
        }
    }

    void save(StateWriter & state) const override { data_->save(state); }
    void load(const StateReader& state) override { edit().load(state); }

private:
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
            auto compact = data_->pack(precision);
            if (this->recipe()) {
                Recipe recipe = *this->recipe();
                recipe.precision = precision;
                dynamic_cast<Saved&>(*compact).set_recipe(std::move(recipe));
            }
            return compact;
        } else {
            throw InputError(
                "this structure has no compact form: choose a tree that holds metrics");
        }
    }

    std::shared_ptr<Data> data_;
};

}  // namespace controlspace
