// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "controlspace/metric/blend.h"
#include "controlspace/metric/metric.h"
#include "controlspace/metric/stored_metrics.h"

namespace controlspace {

/// The bricks of a pool as they are saved.
struct SavedBricks {
    bool are_lengths = false;
    std::vector<std::uint8_t> pool;
    std::vector<std::uint8_t> kinds;  ///< of each brick
    std::vector<double> range;        ///< the shortest and the longest length, where codes need it

    static void exchange(auto& self, auto& state) {
        state("bricks.are_lengths", self.are_lengths);
        state("bricks.pool", self.pool);
        state("bricks.kinds", self.kinds);
        state("bricks.range", self.range);
    }
};

/// How a brick holds the metrics of its vertices, stored as `M`: one after the other.
template <class M>
class BrickCodes {
public:
    static constexpr bool are_codes = false;
    using Item = typename Packing<M>::Item;

    /// For bricks of these metrics. Throws InputError where one cannot be held.
    explicit BrickCodes(std::span<const Metric> metrics);
    explicit BrickCodes(const std::vector<double>& /*range*/) {}
    static std::vector<double> range() { return {}; }
    static constexpr std::size_t table_bytes() { return 0; }

    static constexpr std::size_t kinds = 1;
    static std::uint8_t kind_of(std::span<const Metric>) { return 0; }
    /// Bytes of a brick of so many vertices, of each kind, are whole numbers of this.
    static std::size_t unit(std::size_t vertices) { return bytes_of(0, vertices); }
    static std::size_t bytes_of(std::uint8_t /*kind*/, std::size_t vertices) {
        constexpr std::size_t line = 64;
        const std::size_t bytes = vertices * sizeof(Item);
        const std::size_t whole = std::min(line, std::bit_ceil(bytes));
        return (bytes + whole - 1) / whole * whole;
    }
    static void write(std::uint8_t /*kind*/, std::span<const Metric> vertices, std::byte* brick);
    [[gnu::always_inline]] static const Item& at(const std::byte* brick, std::uint32_t vertex) {
        return reinterpret_cast<const Item*>(brick)[vertex];
    }

    /// Whether a brick that was loaded holds metrics.
    static bool is_sound(std::uint8_t kind, const std::byte* brick, std::size_t vertices);
};

/// Lengths as codes: equal steps from the shortest of the brick to its longest, in 8 bits where
/// these round no more than is allowed, else in 16; or else floats. Allowed is what codes of as
/// many bits round in other compact forms (StoredMetrics). The first length is one of 65536 in
/// equal ratios between the shortest and the longest of all, the step a share of it, one of 256: so
/// a brick of 8 bits is two lines of a cache. Tables are made by multiplication alone: the same
/// bits on every machine.
class LinearCodes {
public:
    static constexpr bool are_codes = true;

    std::vector<double> range() const { return {shortest_, longest_}; }
    static constexpr std::size_t table_bytes() {
        return sizeof fine_ + sizeof coarse_ + sizeof shares_ + sizeof fine_shares;
    }

    static constexpr std::size_t kinds = 3;
    enum Kind : std::uint8_t { bytes = 0, words = 1, floats = 2 };
    std::uint8_t kind_of(std::span<const Metric> vertices) const;
    static std::size_t unit(std::size_t vertices) { return bytes_of(bytes, vertices); }
    static std::size_t bytes_of(std::uint8_t kind, std::size_t vertices) {
        return std::bit_ceil(header(kind) + (vertices << kind));
    }
    void write(std::uint8_t kind, std::span<const Metric> vertices, std::byte* brick) const;

    /// A length is base + scale times a number between the codes of the vertices. Not of floats,
    /// which are lengths.
    struct Scale {
        double base, scale;
    };
    [[gnu::always_inline]] Scale scale_of(std::uint8_t kind, const std::byte* brick) const {
        std::uint16_t first;
        std::memcpy(&first, brick, sizeof first);
        const double base = first_length(first);
        const double share = share_of(std::to_integer<std::size_t>(brick[2]));
        return {base, base * (share * steps_a_byte[kind])};
    }
    template <class Number>
    [[gnu::always_inline]] static Number at(const std::byte* brick, std::uint32_t vertex) {
        Number number;
        constexpr std::uint8_t kind = std::countr_zero(sizeof number);
        std::memcpy(&number, brick + header(kind) + vertex * sizeof number, sizeof number);
        return number;
    }
    /// The code of a vertex, and behind it that of the next, of either length without a branch: in
    /// the lowest bits, code_bits of each. Reads up to two bytes behind the brick.
    [[gnu::always_inline]] static std::uint32_t pair_at(std::uint8_t kind, const std::byte* brick,
                                                        std::uint32_t vertex) {
        std::uint32_t pair;
        std::memcpy(&pair, brick + header(kind) + (vertex << kind), sizeof pair);
        return pair;
    }
    static constexpr std::uint32_t code_bits(std::uint8_t kind) { return 8U << kind; }

    static bool is_sound(std::uint8_t kind, const std::byte* brick, std::size_t vertices);

protected:
    /// Codes that round by a factor of `allowed` at most.
    LinearCodes(double shortest, double longest, double allowed);

private:
    // Of floats as of 16 bits.
    static constexpr std::size_t header(std::uint8_t kind) { return kind == bytes ? 3 : 4; }
    static constexpr std::size_t fine_steps = 256, shares = 256;
    static constexpr std::array<double, 2> steps_a_byte{1, 1.0 / 257};
    // Parts of an octave.
    static constexpr std::array<double, 16> fine_shares = [] {
        std::array<double, 16> powers{};
        double power = 1;
        for (double& p : powers) {
            p = power;
            power *= 1.0442737824274138;
        }
        return powers;
    }();

    [[gnu::always_inline]] double first_length(std::size_t i) const {
        return double{coarse_[i / fine_steps]} * double{fine_[i % fine_steps]};
    }
    [[gnu::always_inline]] double share_of(std::size_t i) const {
        return shares_[i / fine_shares.size()] * fine_shares[i % fine_shares.size()];
    }

    // Tries a kind. Returns the largest factor by which it rounds.
    double encode(std::uint8_t kind, std::span<const Metric> vertices, std::byte* brick) const;
    std::uint16_t first_up_to(double h) const;

    double shortest_, longest_, allowed_;
    std::array<float, fine_steps> fine_{}, coarse_{};
    std::array<double, shares / fine_shares.size()> shares_{};
};

template <>
class BrickCodes<StoredLength<std::uint8_t>> : public LinearCodes {
public:
    explicit BrickCodes(std::span<const Metric> metrics);
    explicit BrickCodes(const std::vector<double>& range);
};
template <>
class BrickCodes<StoredLength<std::uint16_t>> : public LinearCodes {
public:
    explicit BrickCodes(std::span<const Metric> metrics);
    explicit BrickCodes(const std::vector<double>& range);
};

}  // namespace controlspace
