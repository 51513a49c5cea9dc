#include "trees/topology/place_index.h"

#include <bit>

#include "controlspace/geometry/detail/large_pages.h"
#include "geometry/hash_of_words.h"

namespace controlspace {

namespace {

constexpr NodeIndex none = ~NodeIndex{0};
constexpr std::size_t smallest_table = 64;

std::uint64_t hash(const Point& x) {
    return hash_of_words(Vector(Vector::Zero() + x));  // turns -0 into 0: the same place
}

}  // namespace

std::size_t PlaceIndex::slot_of(const Point& x, std::span<const Point> positions) const {
    const std::size_t mask = table_.size() - 1;
    std::size_t slot = hash(x) & mask;
    while (table_[slot] != none && positions[table_[slot]] != x) slot = (slot + 1) & mask;
    return slot;
}

void PlaceIndex::prefetch(const Point& x) const {
    if (!table_.empty()) __builtin_prefetch(&table_[hash(x) & (table_.size() - 1)]);
}

NodeIndex PlaceIndex::likely_at(const Point& x) const {
    return table_.empty() ? none : table_[hash(x) & (table_.size() - 1)];
}

PlaceIndex::PlaceIndex(std::span<const Point> positions) : used_(positions.size()) {
    enter_all(std::max(smallest_table, std::bit_ceil(2 * positions.size())), positions);
}

NodeIndex PlaceIndex::find_or_enter(const Point& x, NodeIndex next,
                                    std::span<const Point> positions) {
    if (2 * used_ >= table_.size()) grow(positions);
    NodeIndex& entry = table_[slot_of(x, positions)];
    if (entry == none) {
        entry = next;
        ++used_;
    }
    return entry;
}

void PlaceIndex::grow(std::span<const Point> positions) {
    enter_all(std::max(smallest_table, 2 * table_.size()), positions);
}

void PlaceIndex::enter_all(std::size_t slots, std::span<const Point> positions) {
    table_ = {};  // so that both are never there together
    table_ = large_array<NodeIndex>(slots, none);
    for (NodeIndex i = 0; i < positions.size(); ++i) table_[slot_of(positions[i], positions)] = i;
}

}  // namespace controlspace
