#include "controlspace/fields/mixture.h"

#include <utility>

#include "controlspace/error.h"
#include "controlspace/metric/evaluate.h"
#include "controlspace/metric/intersection.h"

namespace controlspace {

namespace {

class Mixture final : public MetricField {
public:
    explicit Mixture(std::vector<std::shared_ptr<const MetricField>> fields)
        : fields_(std::move(fields)) {
        if (fields_.empty()) throw InputError("a mixture of no fields: give at least one");
    }

    void evaluate(std::span<const Point> x, std::span<Metric> out) const override {
        evaluate_blocks(x, out, [this](auto points, auto metrics) {
            fields_.front()->evaluate(points, metrics);
            std::vector<Metric> others(points.size());
            for (std::size_t f = 1; f < fields_.size(); ++f) {
                fields_[f]->evaluate(points, others);
                std::transform(metrics.begin(), metrics.end(), others.begin(), metrics.begin(),
                               intersection);
            }
        });
    }

private:
    std::vector<std::shared_ptr<const MetricField>> fields_;
};

}  // namespace

std::unique_ptr<MetricField> mixture(std::vector<std::shared_ptr<const MetricField>> fields) {
    return std::make_unique<Mixture>(std::move(fields));
}

}  // namespace controlspace
