// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "controlspace/metric/metric.h"
#include "controlspace/metric/stored_metric.h"

namespace controlspace {

/// Metrics in an array, stored as `M`: a StoredMetric, or where all are isotropic a StoredLength.
template <class M>
class StoredMetrics {
public:
    using Item = typename Packing<M>::Item;

    /// In their order. Throws InputError where one cannot be held.
    explicit StoredMetrics(std::span<const Metric> metrics);
    /// Those with these numbers, in their order.
    StoredMetrics(std::span<const Metric> metrics, std::span<const std::uint32_t> numbers);

    std::size_t size() const { return items_.size(); }
    decltype(auto) operator[](std::size_t i) const { return packing()(items_[i]); }
    std::span<const Item> items() const { return items_; }
    Packing<M> packing() const {
        if constexpr (requires(Packing<M> p) { p.table; }) {
            return {table_.data()};
        } else {
            return {};
        }
    }
    std::vector<Metric> metrics() const {
        std::vector<Metric> all;
        all.reserve(size());
        for (const Item& item : items_) all.push_back(packing()(item));
        return all;
    }
    std::size_t bytes() const {
        return items_.capacity() * sizeof(Item) + table_.capacity() * sizeof(double);
    }
    /// Leaves no items, only how they are packed.
    void drop_items() { items_ = std::vector<Item>(); }

private:
    template <class MetricAt>
    void store(std::size_t count, const MetricAt& metric_at);

    std::vector<Item> items_;
    std::vector<double> table_;  // see Packing
};

/// Throws InputError for a precision that is none of the named ones: it was cast from a number.
void require_valid(Precision precision);

/// What a metric is stored as where Metric itself serves for one in doubles.
template <class M>
using OrMetric = std::conditional_t<std::is_same_v<M, StoredMetric<double>>, Metric, M>;

/// The largest factor between a length that is stored, by itself or as that of a metric in any
/// direction, and what is read back; of lengths from `shortest` to `longest`.
double rounding_of(Precision precision, bool are_lengths, double shortest, double longest);

/// Throws InputError: codes hold lengths only.
[[noreturn]] void refuse_codes();

/// store(std::type_identity<M>()) for the type that metrics are stored in, which is that of lengths
/// where all are isotropic, if it `may_be_lengths`. Throws InputError for codes of others.
template <bool may_be_lengths, class Store>
auto with_stored(Precision precision, std::span<const Metric> metrics, Store&& store) {
    require_valid(precision);
    const bool floats = precision == Precision::floats;
    if constexpr (may_be_lengths) {
        if (std::ranges::all_of(metrics, is_isotropic)) {
            switch (precision) {
                case Precision::doubles:
                    return store(std::type_identity<StoredLength<double>>());
                case Precision::floats:
                    return store(std::type_identity<StoredLength<float>>());
                case Precision::log16:
                    return store(std::type_identity<StoredLength<std::uint16_t>>());
                case Precision::log8:
                    return store(std::type_identity<StoredLength<std::uint8_t>>());
            }
        }
    }
    if (precision != Precision::doubles && !floats) refuse_codes();
    return floats ? store(std::type_identity<StoredMetric<float>>())
                  : store(std::type_identity<StoredMetric<double>>());
}

}  // namespace controlspace
