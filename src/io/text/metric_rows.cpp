// SPDX-License-Identifier: Apache-2.0
#include "io/text/metric_rows.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "controlspace/sources/riemannian.h"
#include "refuse.h"

namespace controlspace {
namespace {

/// Places of the components that are equal in a symmetric matrix by rows.
constexpr std::array<std::array<std::size_t, 2>, 3> opposite{{{1, 3}, {2, 6}, {5, 7}}};

std::optional<Metric> metric_of(const Metric& given, bool riemannian) {
    if (riemannian) return from_riemannian(given);
    return is_source_metric(given) ? std::optional(given) : std::nullopt;
}

}  // namespace

std::array<double, 9> numbers_of(const Metric& m, const TensorLayout& layout) {
    const Metric t = layout.riemannian ? to_riemannian(m) : m;
    const std::array entries{t.xx, t.yy, t.zz, t.xy, t.xz, t.yz};
    std::array<double, 9> numbers{};
    for (std::size_t i = 0; i < entries.size(); ++i) numbers[layout.indices[i]] = entries[i];
    if (layout.numbers == 9) {
        for (const auto& [i, j] : opposite) numbers[j] = numbers[i];
    }
    return numbers;
}

void MetricRows::add(std::span<const double> numbers) {
    if (numbers.size() == 1) {
        if (!is_length(numbers[0])) {
            refuse("{}: size {} is {}: {}", where_(), count() + 1, numbers[0], length_rule);
        }
        metrics_.push_back(Metric::isotropic(numbers[0]));
        return;
    }
    if (numbers.size() == 9) {
        constexpr double negligible = 1e-6;
        double largest = 0;
        for (const double x : numbers) largest = std::max(largest, std::abs(x));
        for (const auto& [i, j] : opposite) {
            if (!(std::abs(numbers[i] - numbers[j]) > negligible * largest)) continue;
            refuse("{}: tensor {} is not symmetric: {} and {} differ", where_(), count() + 1,
                   numbers[i], numbers[j]);
        }
    }
    const auto entry = [&](std::size_t i) { return numbers[layout_.indices[i]]; };
    const Metric given{entry(0), entry(1), entry(2), entry(3), entry(4), entry(5)};
    if (const auto m = metric_of(given, layout_.riemannian)) {
        metrics_.push_back(*m);
        return;
    }
    indefinite_.push_back(count() + 1);
    if (indefinite_.size() > 1) return;
    first_indefinite_ = fmt::format("{}: tensor {} ({}) is not positive definite", where_(),
                                    indefinite_.front(), fmt::join(numbers, " "));
}

std::vector<Metric> MetricRows::take() {
    if (indefinite_.empty()) return std::move(metrics_);
    const std::string what = fmt::format(
        "{}, {} of {} are not: {}{}?", first_indefinite_, indefinite_.size(), count(),
        layout_.riemannian ? "is the order of their components " : "are they of lengths, ",
        layout_.order);
    throw IndefiniteTensors(what, std::move(metrics_), std::move(indefinite_));
}

void require_coordinates(const Point& x, std::string_view what, std::size_t number,
                         const std::function<std::string()>& where) {
    for (const double c : x) {
        if (is_coordinate(c)) continue;
        refuse(
            "{}: {} {} has a coordinate {}: give finite ones, of at most "
            "{:.0e}",
            where(), what, number, c, largest_magnitude);
    }
}

std::vector<PointSource> sources_from(std::span<const Point> positions,
                                      std::span<const Metric> metrics) {
    std::vector<PointSource> sources(positions.size());
    for (std::size_t i = 0; i < sources.size(); ++i) sources[i] = {positions[i], metrics[i]};
    return sources;
}

void drop_repeated(std::vector<PointSource>& sources) {
    std::set<std::array<double, 9>> seen;
    std::erase_if(sources, [&](const PointSource& source) {
        const auto& [p, m, growth] = source;
        return !seen.insert({p.x(), p.y(), p.z(), m.xx, m.yy, m.zz, m.xy, m.xz, m.yz}).second;
    });
}

}  // namespace controlspace
