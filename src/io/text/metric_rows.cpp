#include "io/text/metric_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "controlspace/error.h"
#include "controlspace/sources/point_source.h"
#include "controlspace/sources/riemannian.h"
#include "io/text/indefinite_tensors.h"

namespace controlspace {

void MetricRows::add_size(double h) {
    if (!is_length(h)) {
        throw InputError(fmt::format("size {} of {} is {}: {}", metrics_.size() + 1, path_.string(),
                                     h, length_rule));
    }
    metrics_.push_back(Metric::isotropic(h));
}

void MetricRows::add_tensor(const Metric& riemannian) {
    const auto m = from_riemannian(riemannian);
    metrics_.push_back(m.value_or(Metric{}));
    if (!m) indefinite_.push_back(metrics_.size());
}

void MetricRows::add_matrix(const std::array<double, 9>& t) {
    constexpr double negligible = 1e-6;
    double largest = 0;
    for (const double x : t) largest = std::max(largest, std::abs(x));
    constexpr std::array<std::array<std::size_t, 2>, 3> opposite{{{1, 3}, {2, 6}, {5, 7}}};
    for (const auto& [i, j] : opposite) {
        if (!(std::abs(t[i] - t[j]) > negligible * largest)) continue;
        throw InputError(fmt::format("tensor {} of {} is not symmetric: {} and {} differ",
                                     metrics_.size() + 1, path_.string(), t[i], t[j]));
    }
    add_tensor({t[0], t[4], t[8], t[1], t[2], t[5]});
}

std::vector<Metric> MetricRows::take() {
    if (!indefinite_.empty()) {
        const std::string what = fmt::format(
            "tensor {} of {} is not positive definite, {} of {} are not: is the order of their "
            "components {}?",
            indefinite_.front(), path_.string(), indefinite_.size(), metrics_.size(), order_);
        throw IndefiniteTensors(what, std::move(metrics_), std::move(indefinite_));
    }
    return std::move(metrics_);
}

}  // namespace controlspace
