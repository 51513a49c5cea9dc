// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "controlspace/trees/cell_model.h"
#include "space/state.h"
#include "trees/values/source_table.h"

namespace controlspace {

/// The sources that govern each leaf, as lists in one flat array. The order within a list counts:
/// cones of tensors are intersected one after the other.
class AnchorLists {
public:
    std::size_t leaves() const { return lists_.size(); }
    std::span<const SourceIndex> of(LeafIndex leaf) const {
        const List& list = lists_[leaf];
        return {sources_.data() + list.first, list.count};
    }
    void prefetch(LeafIndex leaf) const { __builtin_prefetch(&lists_[leaf]); }
    void add(LeafIndex leaf, SourceIndex source);
    void set(LeafIndex leaf, std::span<const SourceIndex> sources);
    /// Appends `n` leaves with the list of `leaf`, which they share until it is changed.
    void repeat(LeafIndex leaf, std::size_t n);
    /// Marks the sources that stand in any list.
    std::vector<std::uint8_t> used(std::size_t sources) const;
    void rename(std::span<const SourceIndex> new_names);

    void save(StateWriter& state) const;
    /// Lists of so many leaves, of so many sources.
    void load(const StateReader& state, std::size_t leaves, std::size_t sources);

    std::size_t bytes() const {
        return lists_.capacity() * sizeof(List) + sources_.capacity() * sizeof(SourceIndex) +
               room_.capacity() * sizeof(std::uint32_t);
    }
    /// Gives back the room of lists that were replaced; lists that are alike one after the other
    /// come to share theirs.
    void shrink_to_fit();

private:
    struct List {
        std::uint32_t first = 0;
        std::uint32_t count = 0;
    };
    List append(std::span<const SourceIndex> sources);

    std::vector<List> lists_{1};  // of a leaf
    std::vector<SourceIndex> sources_;
    // Where long lists grow: for how many sources there is room from a leaf's first on; 0, or
    // nothing, where its list has none of its own.
    std::vector<std::uint32_t> room_;
};

}  // namespace controlspace
