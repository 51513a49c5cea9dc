// SPDX-License-Identifier: Apache-2.0
#include "controlspace/fields/mixture.h"

#include <algorithm>
#include <utility>

#include "controlspace/metric/intersection.h"
#include "refuse.h"

namespace controlspace {

namespace {

class Mixture final : public ControlSpace {
public:
    explicit Mixture(std::vector<std::shared_ptr<const ControlSpace>> fields)
        : fields_(std::move(fields)) {
        if (fields_.empty()) refuse("a mixture of no fields: give at least one");
    }

    void sample(std::span<const Point> x, std::span<Metric> out) const override {
        fields_.front()->sample(x, out);
        std::vector<Metric> others(x.size());
        for (std::size_t f = 1; f < fields_.size(); ++f) {
            fields_[f]->sample(x, others);
            std::transform(out.begin(), out.end(), others.begin(), out.begin(), intersection);
        }
    }
    Box domain() const override {
        Box common = Box::everywhere();
        for (const auto& field : fields_) {
            common.low = common.low.cwiseMax(field->domain().low);
            common.high = common.high.cwiseMin(field->domain().high);
        }
        return common;
    }

private:
    std::vector<std::shared_ptr<const ControlSpace>> fields_;
};

}  // namespace

std::unique_ptr<ControlSpace> mixture(std::vector<std::shared_ptr<const ControlSpace>> fields) {
    return std::make_unique<Mixture>(std::move(fields));
}

}  // namespace controlspace
