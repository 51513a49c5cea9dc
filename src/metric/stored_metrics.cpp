// SPDX-License-Identifier: Apache-2.0
#include "controlspace/metric/stored_metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <ranges>
#include <type_traits>
#include <utility>

#include "controlspace/error.h"
#include "controlspace/metric/nonconformity.h"
#include "require_known.h"

namespace controlspace {

namespace {

constexpr double most_of_floats = 1e-6;  // δ: a length is off by 0.1 %

// Throws InputError if `rounded` is too far from `m`.
void require_close(const Metric& rounded, const Metric& m) {
    const bool in_range =
        std::min({rounded.xx, rounded.yy, rounded.zz}) > std::numeric_limits<float>::min() &&
        is_positive_definite(rounded);
    if (in_range && nonconformity(rounded, m) < most_of_floats) return;
    throw InputError(
        fmt::format("floats cannot hold the metric {} (xx yy zz xy xz yz) to 0.1 % of each "
                    "length: use doubles",
                    to_string(m)));
}

// The shortest and the longest length.
template <class MetricAt>
std::pair<double, double> range_of(std::size_t count, const MetricAt& metric_at) {
    double shortest = std::numeric_limits<double>::infinity(), longest = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const double h = metric_at(i).xx;
        shortest = std::min(shortest, h);
        longest = std::max(longest, h);
    }
    return {shortest, longest};
}

// The last of some ascending numbers that is at most `x`, which the first one is.
std::size_t last_up_to(std::span<const double> ascending, double x) {
    return static_cast<std::size_t>(std::ranges::upper_bound(ascending, x) - ascending.begin() - 1);
}

// Lengths in 16 bits: those between which `fine` steps lie.
std::vector<double> table_of(double shortest, double longest,
                             Packing<StoredLength<std::uint16_t>> powers) {
    std::vector<double> table{static_cast<float>(shortest)};  // as it is saved
    constexpr std::size_t most = std::numeric_limits<std::uint16_t>::max();
    while (table.back() < longest && table.size() * powers.fine_steps <= most) {
        table.push_back(table.back() * powers.fine.back());
    }
    return table;
}

// The largest factor whose 255th power is not more than longest / shortest, found by multiplication
// alone, so that it has the same bits on every machine; both ends are exact, so that what was read
// back is stored in the same codes again.
std::vector<double> table_of(double shortest, double longest,
                             Packing<StoredLength<std::uint8_t>> /*of*/) {
    constexpr std::size_t codes = Packing<StoredLength<std::uint8_t>>::codes;
    const auto powers = [&](double factor) {
        std::vector<double> table(codes, shortest);
        for (std::size_t i = 1; i < codes; ++i) table[i] = table[i - 1] * factor;
        return table;
    };
    double low = 1, high = std::max(1.0, longest / shortest);
    for (double middle; middle = low + (high - low) / 2, low < middle && middle < high;) {
        (powers(middle).back() <= longest ? low : high) = middle;
    }
    std::vector<double> table = powers(low);
    table.back() = longest;
    return table;
}

}  // namespace

template <class M>
template <class MetricAt>
void StoredMetrics<M>::store(std::size_t count, const MetricAt& metric_at) {
    items_.reserve(count);
    if constexpr (std::is_same_v<Item, M>) {
        for (std::size_t i = 0; i < count; ++i) items_.emplace_back(metric_at(i));
        if constexpr (std::is_same_v<M, StoredMetric<float>> ||
                      std::is_same_v<M, StoredLength<float>>) {
            // In a loop of its own: GCC 12 takes what is rounded and widened at once for unrounded.
            for (std::size_t i = 0; i < count; ++i) require_close(items_[i], metric_at(i));
        }
    } else {
        if (count == 0) return;
        const auto [shortest, longest] = range_of(count, metric_at);
        const auto require = [shortest = shortest, longest = longest](bool fits) {
            if (fits) return;
            throw InputError(
                fmt::format("codes of {} bits cannot hold lengths from {:.3g} to {:.3g}: use "
                            "floats, or doubles",
                            8 * sizeof(Item), shortest, longest));
        };
        using Floats = std::numeric_limits<float>;
        require(shortest >= Floats::min() && longest < Floats::max() / 2);
        table_ = table_of(shortest, longest, Packing<M>());
        table_.shrink_to_fit();
        for (std::size_t i = 0; i < count; ++i) {
            const double h = metric_at(i).xx;
            const std::size_t part = last_up_to(table_, std::max(h, table_.front()));
            std::size_t code = part;
            if constexpr (sizeof(Item) == 1) {
                // The next one, if that is nearer.
                if (part + 1 < table_.size() && table_[part + 1] / h < h / table_[part]) ++code;
            } else {
                static const double half_step = std::sqrt(Packing<M>::step);
                code = part * Packing<M>::fine_steps +
                       last_up_to(Packing<M>::fine, h / table_[part] * half_step);
            }
            require(code <= std::numeric_limits<Item>::max());
            items_.push_back(static_cast<Item>(code));
        }
    }
}

template <class M>
StoredMetrics<M>::StoredMetrics(std::span<const Metric> metrics) {
    store(metrics.size(), [&](std::size_t i) -> const Metric& { return metrics[i]; });
}

template <class M>
StoredMetrics<M>::StoredMetrics(std::span<const Metric> metrics,
                                std::span<const std::uint32_t> numbers) {
    store(numbers.size(), [&](std::size_t i) -> const Metric& { return metrics[numbers[i]]; });
}

void require_valid(Precision precision) { require_known("precision", precision, Precision::log8); }

double rounding_of(Precision precision, bool are_lengths, double shortest, double longest) {
    require_valid(precision);
    constexpr double of_float = 1 + 6e-8;  // half a unit in its last place
    switch (precision) {
        case Precision::floats:
            return are_lengths ? of_float : largest_factor_along(most_of_floats);
        case Precision::log16:
            return std::sqrt(Packing<StoredLength<std::uint16_t>>::step) * of_float;
        case Precision::log8:
            return std::pow(longest / shortest, 0.5 / 255) * (1 + 1e-12);
        default:
            return 1;
    }
}

void refuse_codes() {
    throw InputError(
        "codes of 16 and 8 bits hold lengths, where all metrics are isotropic: use floats");
}

template class StoredMetrics<StoredMetric<float>>;
template class StoredMetrics<StoredMetric<double>>;
template class StoredMetrics<StoredLength<float>>;
template class StoredMetrics<StoredLength<double>>;
template class StoredMetrics<StoredLength<std::uint16_t>>;
template class StoredMetrics<StoredLength<std::uint8_t>>;

}  // namespace controlspace
