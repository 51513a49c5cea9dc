#pragma once

#include <utility>

#include "controlspace/metric/evaluate.h"
#include "controlspace/metric/metric_field.h"

namespace controlspace {

/// The field whose metric at `p` is `formula(p)`.
template <class Formula>
class FormulaField final : public MetricField {
public:
    explicit FormulaField(Formula formula) : formula_(std::move(formula)) {}

    void evaluate(std::span<const Point> x, std::span<Metric> out) const override {
        evaluate_each(x, out, [this](const Point& p) { return formula_(p); });
    }

private:
    Formula formula_;
};

}  // namespace controlspace
