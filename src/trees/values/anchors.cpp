// SPDX-License-Identifier: Apache-2.0
#include "trees/values/anchors.h"

#include <algorithm>
#include <limits>

#include "controlspace/error.h"

namespace controlspace {

AnchorLists::List AnchorLists::append(std::span<const SourceIndex> sources) {
    if (sources_.size() + sources.size() > std::numeric_limits<std::uint32_t>::max()) {
        throw InputError("leaves hold 2^32 anchors at most: raise l_min or the target");
    }
    const List list{static_cast<std::uint32_t>(sources_.size()),
                    static_cast<std::uint32_t>(sources.size())};
    sources_.insert(sources_.end(), sources.begin(), sources.end());
    return list;
}

void AnchorLists::add(LeafIndex leaf, SourceIndex source) {
    List& list = lists_[leaf];
    // The last list grows where it is: a list that another leaf has in common with it ends before.
    if (std::size_t{list.first} + list.count == sources_.size()) {
        append({&source, 1});
        ++list.count;
        return;
    }
    // So does one with room. Leaves that have a list in common have its beginning alone.
    if (leaf < room_.size() && room_[leaf] > list.count) {
        sources_[std::size_t{list.first} + list.count++] = source;
        return;
    }
    const auto old = of(leaf);
    std::vector<SourceIndex> longer(old.begin(), old.end());
    longer.push_back(source);
    constexpr std::size_t few = 64;
    const std::size_t room = longer.size() < few ? longer.size() : 2 * longer.size();
    longer.resize(room, source);
    const auto count = list.count + 1;
    list = {append(longer).first, count};
    if (room == count) return;
    room_.resize(lists_.size(), 0);
    room_[leaf] = static_cast<std::uint32_t>(room);
}

void AnchorLists::set(LeafIndex leaf, std::span<const SourceIndex> sources) {
    if (std::ranges::equal(of(leaf), sources)) return;
    lists_[leaf] = append(sources);
    if (leaf < room_.size()) room_[leaf] = 0;
}

void AnchorLists::repeat(LeafIndex leaf, std::size_t n) {
    const List list = lists_[leaf];
    lists_.insert(lists_.end(), n, list);
}

std::vector<std::uint8_t> AnchorLists::used(std::size_t sources) const {
    std::vector<std::uint8_t> used(sources, 0);
    for (LeafIndex leaf = 0; leaf < leaves(); ++leaf) {
        for (const SourceIndex source : of(leaf)) used[source] = 1;
    }
    return used;
}

void AnchorLists::rename(std::span<const SourceIndex> new_names) {
    for (SourceIndex& source : sources_) source = new_names[source];
}

void AnchorLists::save(StateWriter& state) const {
    std::vector<std::array<std::uint32_t, 2>> lists;
    lists.reserve(lists_.size());
    for (const List& list : lists_) lists.push_back({list.first, list.count});
    state("anchors.lists", lists);
    state("anchors.sources", sources_);
}

void AnchorLists::load(const StateReader& state, std::size_t leaves, std::size_t sources) {
    std::vector<std::array<std::uint32_t, 2>> lists;
    state("anchors.lists", lists);
    state("anchors.sources", sources_);
    state.require(lists.size() == leaves, "anchors.lists", "has another number of leaves");
    require_below(state, "anchors.sources", sources_, sources);
    lists_.clear();
    room_.clear();
    lists_.reserve(lists.size());
    for (const auto& [first, count] : lists) {
        state.require(std::uint64_t{first} + count <= sources_.size(), "anchors.lists",
                      "names what is not there");
        lists_.push_back({first, count});
    }
}

void AnchorLists::shrink_to_fit() {
    AnchorLists dense;
    dense.lists_.clear();
    dense.lists_.reserve(lists_.size());
    for (LeafIndex leaf = 0; leaf < leaves(); ++leaf) {
        if (leaf > 0 && std::ranges::equal(of(leaf), of(leaf - 1))) {
            dense.lists_.push_back(dense.lists_.back());
        } else {
            dense.lists_.push_back(dense.append(of(leaf)));
        }
    }
    dense.sources_.shrink_to_fit();
    *this = std::move(dense);
}

}  // namespace controlspace
