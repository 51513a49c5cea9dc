// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "baselines/lattice/stencil.h"
#include "baselines/openvdb/brick_codes.h"
#include "baselines/openvdb/brick_octree.h"
#include "controlspace/metric/blend.h"

namespace controlspace {

/// What a tree of bricks holds: where a brick is in the pool, in units; its kind; its level.
struct BrickRef {
    static constexpr std::uint32_t level_bits = 5, kind_bits = 2;
    static constexpr std::uint32_t unit_bits = 32 - level_bits - kind_bits;

    std::uint32_t bits = 0;

    std::size_t unit() const { return bits >> (level_bits + kind_bits); }
    std::uint8_t kind() const {
        return static_cast<std::uint8_t>(bits >> level_bits & ((1U << kind_bits) - 1));
    }
    std::size_t level() const { return bits & ((1U << level_bits) - 1); }
    static std::uint32_t of(std::size_t unit, std::uint8_t kind, int level) {
        return (static_cast<std::uint32_t>(unit) << kind_bits | kind) << level_bits |
               static_cast<std::uint32_t>(level);
    }
};

/// Some places in their bricks: the low corner of the cell, as a vertex, and the fractions of the
/// cell's edges.
struct PlacesInBricks {
    static constexpr std::size_t most = CellBatch::most;
    template <class Number>
    using Each = std::array<Number, most>;

    Each<BrickRef> ref;
    Each<const std::byte*> brick;
    Each<std::uint32_t> vertex;
    std::array<Each<double>, 3> t;
};

/// A value between those of the eight corners of a cell, at the fractions of its edges.
[[gnu::always_inline]] inline double trilinear(const auto& at, double x, double y, double z) {
    const auto along_z = [&](std::size_t c) { return (1 - z) * at(c) + z * at(c + 4); };
    const double low = (1 - y) * along_z(0) + y * along_z(2);
    const double high = (1 - y) * along_z(1) + y * along_z(3);
    return (1 - x) * low + x * high;
}

/// The vertices of an octree's bricks, stored as `M` in one block of memory.
template <class M>
class BrickPool {
    using Codes = BrickCodes<M>;
    struct alignas(64) Line {
        std::array<std::byte, 64> bytes;
    };

public:
    static constexpr bool are_lengths = is_stored_length<M>;
    static constexpr bool are_codes = Codes::are_codes;
    using Value = std::conditional_t<are_lengths, StoredLength<double>, Metric>;

    /// Where bricks will be, before there is memory for them.
    BrickPool(const BrickOctree& octree, const Bricks& bricks)
        : lattice_(octree.domain()),
          codes_(octree.saved() ? Codes(octree.saved()->range) : Codes(octree.metrics())),
          kinds_(octree.saved() ? octree.saved()->kinds : kinds_of(octree, bricks)),
          first_(first_units(lattice_, kinds_)) {}

    const BrickLattice& lattice() const { return lattice_; }
    std::size_t units() const { return first_.back(); }
    /// Bytes that `fill` will allocate, but for part of a line.
    double bytes_to_come() const {
        return static_cast<double>(units()) * static_cast<double>(unit_);
    }
    /// Until it is filled.
    std::uint32_t ref(std::size_t brick, int level) const {
        return BrickRef::of(first_[brick], kinds_[brick], level);
    }
    void fill(const BrickOctree& octree, const Bricks& bricks) {
        pool_.resize(units() * unit_ / sizeof(Line) + 1, Line{});  // LinearCodes::pair_at
        if (const auto& saved = octree.saved()) {
            std::memcpy(pool_.data(), saved->pool.data(), saved->pool.size());
        } else {
            for_each_brick(octree, bricks, [&](std::size_t brick, std::span<const Metric> at) {
                codes_.write(kinds_[brick], at,
                             reinterpret_cast<std::byte*>(pool_.data()) + first_[brick] * unit_);
            });
        }
        if constexpr (!Codes::are_codes) kinds_ = {};
        first_ = {};
    }

    const std::byte* brick_of(BrickRef ref) const {
        return reinterpret_cast<const std::byte*>(pool_.data()) + ref.unit() * unit_;
    }
    static void prefetch(const std::byte* brick) {
        __builtin_prefetch(brick);
        if constexpr (Codes::are_codes) __builtin_prefetch(brick + sizeof(Line));
    }
    Metric vertex(BrickRef ref, std::uint32_t number) const {
        if constexpr (Codes::are_codes) {
            return length(number_between(ref.kind(), brick_of(ref),
                                         [&](const auto& at) { return at(number); }));
        } else {
            return Codes::at(brick_of(ref), number);
        }
    }
    /// In the cell whose low corner is a vertex of the brick, at the fractions of its edges.
    [[gnu::always_inline]] Value value_in(BrickRef ref, const std::byte* brick,
                                          std::uint32_t vertex, double x, double y,
                                          double z) const {
        if constexpr (Codes::are_codes) {
            return length(number_between(ref.kind(), brick, [&](const auto& number) {
                const auto at = [&](std::size_t c) { return number(vertex + to_corner_[c]); };
                return trilinear(at, x, y, z);
            }));
        } else if constexpr (are_lengths) {
            const auto at = [&](std::size_t c) {
                return double{Codes::at(brick, vertex + to_corner_[c]).h};
            };
            return length(trilinear(at, x, y, z));
        } else {
            const std::array<double, 8> weights = corner_weights({x, y, z});
            return blend<Metric>(
                8, [&](std::size_t c) { return weights[c]; },
                [&](std::size_t c) -> decltype(auto) {
                    return Codes::at(brick, vertex + to_corner_[c]);
                });
        }
    }
    /// put(i, value) for the first places.
    template <class Put>
    void answer(const PlacesInBricks& places, std::size_t count, const Put& put) const {
        const auto value_at = [&](std::size_t i) {
            return value_in(places.ref[i], places.brick[i], places.vertex[i], places.t[0][i],
                            places.t[1][i], places.t[2][i]);
        };
        if constexpr (Codes::are_codes) {
            decode(places, count, put, value_at);
        } else {
            for (std::size_t i = 0; i < count; ++i) {  // the four edges along z
                for (std::size_t c = 0; c < 4; ++c) {
                    __builtin_prefetch(
                        &Codes::at(places.brick[i], places.vertex[i] + to_corner_[c]));
                }
            }
            for (std::size_t i = 0; i < count; ++i) put(i, value_at(i));
        }
    }

    std::size_t bytes_payload() const {
        return pool_.capacity() * sizeof(Line) + Codes::table_bytes();
    }
    std::size_t bytes_auxiliary() const { return kinds_.capacity(); }

    /// Of so many bricks.
    SavedBricks saved(std::size_t bricks) const {
        SavedBricks saved{are_lengths, {}, kinds_, codes_.range()};
        saved.kinds.resize(bricks);  // where there is one alone, none are kept
        const auto* first = reinterpret_cast<const std::uint8_t*>(pool_.data());
        saved.pool.assign(first, first + first_units(lattice_, saved.kinds).back() * unit_);
        return saved;
    }
    /// Whether what was loaded, of so many bricks, can be read.
    static bool is_sound(const SavedBricks& saved, std::size_t bricks, const Box& domain) {
        if (saved.kinds.size() != bricks || saved.are_lengths != are_lengths) return false;
        if (std::ranges::max(saved.kinds) >= Codes::kinds) return false;
        if constexpr (Codes::are_codes) {
            using Limits = std::numeric_limits<float>;
            if (saved.range.size() != 2) return false;
            const double shortest = saved.range[0], longest = saved.range[1];
            if (!(shortest >= Limits::min() && shortest <= longest &&
                  longest < Limits::max() / 2)) {
                return false;
            }
        }
        const BrickLattice lattice(domain);
        const std::vector<std::size_t> first = first_units(lattice, saved.kinds);
        const std::size_t unit = Codes::unit(lattice.vertices());
        if (saved.pool.size() != first.back() * unit) return false;
        const Codes codes(saved.range);
        for (std::size_t brick = 0; brick < bricks; ++brick) {
            const auto* bytes =
                reinterpret_cast<const std::byte*>(&saved.pool[first[brick] * unit]);
            if (!codes.is_sound(saved.kinds[brick], bytes, lattice.vertices())) return false;
        }
        return true;
    }

private:
    // Where bricks begin in the pool, in units, and where the last one ends.
    static std::vector<std::size_t> first_units(const BrickLattice& lattice,
                                                std::span<const std::uint8_t> kinds) {
        const std::size_t vertices = lattice.vertices(), unit = Codes::unit(vertices);
        std::vector<std::size_t> first{0};
        first.reserve(kinds.size() + 1);
        for (const std::uint8_t kind : kinds) {
            first.push_back(first.back() + Codes::bytes_of(kind, vertices) / unit);
        }
        return first;
    }
    // visit(brick, metrics) with the metrics of its vertices; on all of TBB's threads.
    template <class Visit>
    void for_each_brick(const BrickOctree& octree, const Bricks& bricks, const Visit& visit) const {
        tbb::parallel_for(std::size_t{0}, bricks.parts.size(), [&](std::size_t brick) {
            const BrickMetrics metrics = metrics_of_brick(octree, bricks.parts[brick], lattice_);
            visit(brick, std::span(metrics).first(lattice_.vertices()));
        });
    }
    std::vector<std::uint8_t> kinds_of(const BrickOctree& octree, const Bricks& bricks) const {
        std::vector<std::uint8_t> kinds(bricks.parts.size(), 0);
        if constexpr (Codes::are_codes) {
            for_each_brick(octree, bricks, [&](std::size_t brick, std::span<const Metric> at) {
                kinds[brick] = codes_.kind_of(at);
            });
        }
        return kinds;
    }

    static Value length(double h) requires are_lengths {
        StoredLength<double> value;
        value.h = h;
        return value;
    }
    // A length, of between(at): at(vertex) is the number that a vertex has.
    template <class Between>
    [[gnu::always_inline]] double number_between(
        std::uint8_t kind, const std::byte* brick,
        const Between& between) const requires Codes::are_codes {
        const auto at = [&](auto number) {
            return between([&](std::uint32_t vertex) {
                return static_cast<double>(Codes::template at<decltype(number)>(brick, vertex));
            });
        };
        if (kind == Codes::floats) return at(float());
        const auto [base, scale] = codes_.scale_of(kind, brick);
        if (kind == Codes::bytes) return base + scale * at(std::uint8_t());
        return base + scale * at(std::uint16_t());
    }
    // As value_in does, side by side; bricks of floats one by one. On a plane across z the second
    // code of a pair is another's, which weighs nothing.
    template <class Put, class ValueAt>
    void decode(const PlacesInBricks& places, std::size_t count, const Put& put,
                const ValueAt& value_at) const requires Codes::are_codes {
        using Places = PlacesInBricks;
        // Codes at the ends of the cell's edges along z, side by side in one number.
        std::array<Places::Each<std::uint32_t>, 4> pair;
        Places::Each<std::uint32_t> bits;
        Places::Each<double> bases, scales, value;
        Places::Each<std::uint8_t> in_floats;
        std::size_t floats = 0;
        for (std::size_t i = 0; i < count; ++i) {
            in_floats[floats] = static_cast<std::uint8_t>(i);
            floats += places.ref[i].kind() == Codes::floats ? 1 : 0;
            const std::uint8_t kind = places.ref[i].kind() & 1;
            const std::byte* brick = places.brick[i];
            const auto [base, scale] = codes_.scale_of(kind, brick);
            bases[i] = base;
            scales[i] = scale;
            bits[i] = Codes::code_bits(kind);
            for (std::size_t c = 0; c < 4; ++c) {
                pair[c][i] = Codes::pair_at(kind, brick, places.vertex[i] + to_corner_[c]);
            }
        }
        for (std::size_t i = 0; i < count; ++i) {
            const std::uint32_t mask = (1U << bits[i]) - 1;
            const auto at = [&](std::size_t c) {
                const std::uint32_t code = pair[c & 3][i] >> (c < 4 ? 0 : bits[i]);
                return static_cast<double>(static_cast<std::int32_t>(code & mask));
            };
            value[i] = bases[i] +
                       scales[i] * trilinear(at, places.t[0][i], places.t[1][i], places.t[2][i]);
        }
        for (const std::uint8_t i : std::span(in_floats).first(floats)) value[i] = value_at(i).h;
        for (std::size_t i = 0; i < count; ++i) put(i, length(value[i]));
    }

    BrickLattice lattice_;
    std::array<std::uint32_t, 8> to_corner_ = lattice_.to_corners();
    std::size_t unit_ = Codes::unit(lattice_.vertices());
    Codes codes_;
    std::vector<std::uint8_t> kinds_;  // of the bricks, where there are several
    std::vector<std::size_t> first_;   // until it is filled
    std::vector<Line> pool_;
};

}  // namespace controlspace
