// SPDX-License-Identifier: Apache-2.0
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
    Box domain() const override { return domain_; }

private:
    Function f_;
    Box domain_{Point(-1, -1, -1), Point(1, 1, 1)};
};

}  // namespace controlspace
