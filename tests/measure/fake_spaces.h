#pragma once

#include <functional>
#include <utility>

#include "controlspace/space/control_space.h"

namespace controlspace {

/// A control space that answers what a function says. It can be read, and no more.
class FunctionSpace : public ControlSpace {
public:
    using Function = std::function<Metric(const Point&)>;
    explicit FunctionSpace(Function f) : f_(std::move(f)) {}

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        for (std::size_t i = 0; i < x.size(); ++i) out[i] = f_(x[i]);
    }
    Insertion insert(const PointSource&) override { return Insertion::already_met; }
    InsertionReport insert(std::span<const PointSource>) override { return {}; }
    ControlNodes control_nodes(Neighbourhood) const override { return {}; }
    void assign(std::span<const Metric>) override {}
    const Box& domain() const override { return domain_; }
    Box element_at(const Point&) const override { return domain_; }
    Footprint footprint() const override { return {}; }

private:
    Function f_;
    Box domain_{Point(-1, -1, -1), Point(1, 1, 1)};
};

}  // namespace controlspace
