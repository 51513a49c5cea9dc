#include "sources/metric_rows.h"

#include <fmt/format.h>

#include <utility>

#include "error.h"
#include "sources/point_source.h"
#include "sources/riemannian.h"

namespace controlspace {

void MetricRows::add_size(double h) {
    if (!is_length(h)) {
        throw InputError(fmt::format("size {} of {} is {}: a length must be positive",
                                     metrics_.size() + 1, path_.string(), h));
    }
    metrics_.push_back(Metric::isotropic(h));
}

void MetricRows::add_tensor(const Metric& riemannian) {
    const auto m = from_riemannian(riemannian);
    metrics_.push_back(m.value_or(Metric{}));
    if (!m && wrong_++ == 0) first_wrong_ = metrics_.size();
}

std::vector<Metric> MetricRows::take() {
    if (wrong_ > 0) {
        throw InputError(fmt::format(
            "tensor {} of {} is not positive definite, {} of {} are not: is the order of their "
            "components {}?",
            first_wrong_, path_.string(), wrong_, metrics_.size(), order_));
    }
    return std::move(metrics_);
}

}  // namespace controlspace
