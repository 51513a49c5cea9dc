#include <fmt/format.h>

#include <algorithm>
#include <limits>
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
std::vector<M> stored_metrics(std::span<const Metric> metrics, std::span<const NodeIndex> numbers) {
    std::vector<M> result;
    result.reserve(numbers.size());
    for (const NodeIndex i : numbers) result.emplace_back(metrics[i]);
    if constexpr (std::is_same_v<M, StoredMetric<float>> ||
                  std::is_same_v<M, StoredLength<float>>) {
        // In a loop of its own: GCC 12 takes what is rounded and widened at once for unrounded.
        for (std::size_t k = 0; k < result.size(); ++k) {
            require_close(result[k], metrics[numbers[k]]);
        }
    }
    return result;
}

template std::vector<StoredMetric<float>> stored_metrics(std::span<const Metric>,
                                                         std::span<const NodeIndex>);
template std::vector<StoredMetric<double>> stored_metrics(std::span<const Metric>,
                                                          std::span<const NodeIndex>);
template std::vector<StoredLength<float>> stored_metrics(std::span<const Metric>,
                                                         std::span<const NodeIndex>);
template std::vector<StoredLength<double>> stored_metrics(std::span<const Metric>,
                                                          std::span<const NodeIndex>);

}  // namespace controlspace
