#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <ranges>
#include <type_traits>
#include <vector>

#include "controlspace/error.h"
#include "controlspace/metric/nonconformity.h"
#include "controlspace/trees/detail/packed_tree.h"

namespace controlspace {

namespace {

// Throws InputError if `rounded` is too far from `m`.
void require_close(const Metric& rounded, const Metric& m) {
    constexpr double most = 1e-6;  // a length is off by 0.1 %
    const bool in_range =
        std::min({rounded.xx, rounded.yy, rounded.zz}) > std::numeric_limits<float>::min() &&
        is_positive_definite(rounded);
    if (in_range && nonconformity(rounded, m) < most) return;
    throw InputError(
        fmt::format("floats cannot hold the metric {} (xx yy zz xy xz yz) to 0.1 % of each "
                    "length: use doubles",
                    to_string(m)));
}

}  // namespace

template <class M>
StoredMetrics<M>::StoredMetrics(std::span<const Metric> metrics,
                                std::span<const NodeIndex> numbers) {
    items_.reserve(numbers.size());
    for (const NodeIndex i : numbers) items_.emplace_back(metrics[i]);
    if constexpr (std::is_same_v<M, StoredMetric<float>> ||
                  std::is_same_v<M, StoredLength<float>>) {
        // In a loop of its own: GCC 12 takes what is rounded and widened at once for unrounded.
        for (std::size_t k = 0; k < size(); ++k) require_close(items_[k], metrics[numbers[k]]);
    }
}

template <>
StoredMetrics<StoredLength<std::uint16_t>>::StoredMetrics(std::span<const Metric> metrics,
                                                          std::span<const NodeIndex> numbers) {
    using Powers = Packing<StoredLength<std::uint16_t>>;
    constexpr std::size_t most = std::numeric_limits<Item>::max();
    const auto length = [&](NodeIndex i) { return metrics[i].xx; };
    const auto [shortest, longest] = std::ranges::minmax(numbers | std::views::transform(length));
    const auto require = [shortest = shortest, longest = longest](bool fits) {
        if (fits) return;
        throw InputError(
            fmt::format("shorts cannot hold lengths from {:.3g} to {:.3g}: use floats, or doubles",
                        shortest, longest));
    };
    using Floats = std::numeric_limits<float>;
    require(shortest >= Floats::min() && longest < Floats::max() / 2);
    coarse_.push_back(static_cast<float>(shortest));  // as it is saved
    while (coarse_.back() < longest && coarse_.size() * Powers::fine_steps <= most) {
        coarse_.push_back(coarse_.back() * Powers::fine.back());
    }
    coarse_.shrink_to_fit();
    const auto last_up_to = [](const auto& ascending, double x) {
        return static_cast<std::size_t>(std::ranges::upper_bound(ascending, x) -
                                        std::ranges::begin(ascending) - 1);
    };
    const double half_step = std::sqrt(Powers::step);
    items_.reserve(numbers.size());
    for (const NodeIndex i : numbers) {
        const double h = length(i);
        const std::size_t part = last_up_to(coarse_, std::max(h, coarse_.front()));
        const std::size_t rest = last_up_to(Powers::fine, h / coarse_[part] * half_step);
        const std::size_t code = part * Powers::fine_steps + rest;
        require(code <= most);
        items_.push_back(static_cast<Item>(code));
    }
}

void refuse_shorts() {
    throw InputError("shorts hold lengths, where all metrics are isotropic: use floats");
}

template StoredMetrics<StoredMetric<float>>::StoredMetrics(std::span<const Metric>,
                                                           std::span<const NodeIndex>);
template StoredMetrics<StoredMetric<double>>::StoredMetrics(std::span<const Metric>,
                                                            std::span<const NodeIndex>);
template StoredMetrics<StoredLength<float>>::StoredMetrics(std::span<const Metric>,
                                                           std::span<const NodeIndex>);
template StoredMetrics<StoredLength<double>>::StoredMetrics(std::span<const Metric>,
                                                            std::span<const NodeIndex>);

}  // namespace controlspace
