#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

namespace controlspace {

/// Things that wait in the order of a length, put in buckets whose lengths differ by 1.6 % at most:
/// what goes in later than something shorter... Costs less than a heap, where most of what
/// waits is thrown away in the end.
class LengthQueue {
public:
    struct Waiting {
        double length;        ///< positive
        std::uint32_t rank;   ///< the lower first where lengths are equal
        std::uint32_t place;  ///< of the thing
        std::uint32_t next;   ///< in the same bucket
    };

    /// Empties the queue, for lengths from `least` to `most`.
    void reset(double least, double most) {
        first_ = key(least);
        current_ = 0;
        waiting_.clear();
        heads_.assign(key(most) - first_ + 1, none);
    }

    void push(double length, std::uint32_t rank, std::uint32_t place) {
        const std::uint64_t k = std::max(key(length), first_) - first_;
        std::uint32_t& head = heads_[std::clamp<std::uint64_t>(k, current_, heads_.size() - 1)];
        waiting_.push_back({length, rank, place, head});
        head = static_cast<std::uint32_t>(waiting_.size() - 1);
    }

    /// Goes to the shortest bucket that is not empty; false if all are.
    bool advance() {
        while (current_ < heads_.size() && heads_[current_] == none) ++current_;
        return current_ < heads_.size();
    }
    /// Whether something is in the present bucket.
    bool has_more() const { return heads_[current_] != none; }
    /// Takes something, in no order, out of the present bucket.
    Waiting take() {
        const Waiting taken = waiting_[heads_[current_]];
        heads_[current_] = taken.next;
        return taken;
    }

private:
    static constexpr std::uint32_t none = ~std::uint32_t{0};
    // Of positive numbers the bits are in the order of the numbers: the exponent and six bits more.
    static std::uint64_t key(double length) { return std::bit_cast<std::uint64_t>(length) >> 46; }

    std::uint64_t first_ = 0;
    std::uint64_t current_ = 0;
    std::vector<std::uint32_t> heads_;
    std::vector<Waiting> waiting_;
};

}  // namespace controlspace
