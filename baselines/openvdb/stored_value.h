// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "baselines/openvdb/dense_tree.h"
#include "baselines/openvdb/openvdb_value.h"
#include "controlspace/metric/stored_metrics.h"

namespace controlspace {

/// What stands for a metric that is stored as `M` in a tree, and back.
template <class M>
struct VdbValue {  // a tensor
    using Type = VdbTensor<M>;
    static constexpr bool is_code = false;

    static Type of(const M& m) { return Type(m); }
    const M& operator()(const Type& value) const { return value.metric; }

    [[no_unique_address]] Packing<M> packing = {};
};
template <class Number>
requires std::is_floating_point_v<Number>
struct VdbValue<StoredLength<Number>> {
    using Type = Number;
    static constexpr bool is_code = false;

    static Type of(const StoredLength<Number>& length) { return length.h; }
    StoredLength<Number> operator()(Number h) const {
        StoredLength<Number> length;
        length.h = h;
        return length;
    }

    [[no_unique_address]] Packing<StoredLength<Number>> packing = {};
};
template <class Code>
requires std::is_integral_v<Code>
struct VdbValue<StoredLength<Code>> {
    using Type = Code;
    static constexpr bool is_code = true;

    static Type of(Code code) { return code; }
    StoredLength<Code> operator()(Code code) const { return packing(code); }

    Packing<StoredLength<Code>> packing;
};

/// Metrics stored as `M` for a tree; none where a tree holds Metric itself.
template <class M>
using VdbStored = std::optional<
    StoredMetrics<std::conditional_t<std::is_same_v<M, Metric>, StoredLength<double>, M>>>;
template <class M>
VdbValue<M> vdb_value(const VdbStored<M>& stored) {
    if constexpr (std::is_same_v<M, Metric>) {
        return {};
    } else {
        return {stored->packing()};
    }
}

/// Reads metrics stored as `M` from a tree, as Stencil::sample requests.
template <class M, class Tree>
class StoredReader : public TreeReader<Tree> {
    using Base = TreeReader<Tree>;

public:
    StoredReader(const Tree& tree, const VdbValue<M>& value) : Base(tree), value_(value) {}

    decltype(auto) operator()(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
        return value_(Base::operator()(i, j, k));
    }
    template <std::size_t corners>
    decltype(auto) metric(const std::array<const typename VdbValue<M>::Type*, corners>& at,
                          std::size_t corner) const {
        return value_(*at[corner]);
    }

private:
    VdbValue<M> value_;
};

}  // namespace controlspace
