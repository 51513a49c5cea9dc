// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

namespace controlspace {

/// Things that wait in the order of a length, in buckets whose lengths differ by 1.6 % at most. For
/// searches that throw away most of what waits: only what is left of a bucket has to be sorted.
class LengthQueue {
public:
    struct Waiting {
        double length;
        std::uint32_t rank;   ///< the lower comes first where lengths are equal
        std::uint32_t place;  ///< of the thing, wherever it is kept
        std::uint32_t next;   ///< in the same bucket

        bool operator<(const Waiting& other) const {
            return length != other.length ? length < other.length : rank < other.rank;
        }
    };

    /// Empties the queue. Positive lengths are distinguished from `least` to `most`.
    void reset(double least, double most) {
        first_key_ = key(least);
        present_ = 0;
        waiting_.clear();
        buckets_.assign(key(most) - first_key_ + 1, none);
    }

    /// What is shorter than the present bucket goes there; what is too long, to the last.
    void push(double length, std::uint32_t rank, std::uint32_t place) {
        const std::uint64_t number = std::max(key(length), first_key_ + present_) - first_key_;
        std::uint32_t& bucket = buckets_[std::min(number, buckets_.size() - 1)];
        waiting_.push_back({length, rank, place, bucket});
        bucket = static_cast<std::uint32_t>(waiting_.size() - 1);
    }

    /// Goes on to the next bucket that holds something; false if none does.
    bool advance() {
        while (present_ < buckets_.size() && !has_more()) ++present_;
        return present_ < buckets_.size();
    }
    /// Whether the present bucket holds something.
    bool has_more() const { return buckets_[present_] != none; }
    /// Takes something, whatever its length, out of the present bucket.
    Waiting take() {
        const Waiting taken = waiting_[buckets_[present_]];
        buckets_[present_] = taken.next;
        return taken;
    }

private:
    static constexpr std::uint32_t none = ~std::uint32_t{0};
    // The exponent and six bits of the mantissa: in the order of the numbers.
    static std::uint64_t key(double length) { return std::bit_cast<std::uint64_t>(length) >> 46; }

    std::uint64_t first_key_ = 0;
    std::uint64_t present_ = 0;
    std::vector<std::uint32_t> buckets_;  ///< the last that came in
    std::vector<Waiting> waiting_;        ///< and what came before it in the same bucket
};

}  // namespace controlspace
