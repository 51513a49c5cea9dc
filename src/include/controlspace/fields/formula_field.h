// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cassert>
#include <cstddef>
#include <memory>
#include <utility>

#include "controlspace/space/control_space.h"

namespace controlspace {

/// The field whose metric at `p` is `formula(p)`, for p in `domain`. The formula is called from
/// several threads at once where the field is sampled so.
template <class Formula>
class FormulaField final : public ControlSpace {
public:
    explicit FormulaField(Formula formula, const Box& domain = Box::everywhere())
        : formula_(std::move(formula)), domain_(domain) {}

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        assert(x.size() == out.size());
        for (std::size_t i = 0; i < x.size(); ++i) {
            out[i] = formula_(nearest_in(domain_, x[i]));
        }
    }
    Box domain() const override { return domain_; }

private:
    Formula formula_;
    Box domain_;
};

/// The same, shared.
template <class Formula>
std::shared_ptr<const ControlSpace> formula_field(Formula formula,
                                                  const Box& domain = Box::everywhere()) {
    return std::make_shared<FormulaField<Formula>>(std::move(formula), domain);
}

}  // namespace controlspace
