#pragma once

#include <algorithm>
#include <type_traits>
#include <unordered_set>
#include <vector>

#include "trees/topology/topology.h"

namespace controlspace {

/// Which leaves of the last gradation have been cut since. A cut leaf's number goes on as that of
/// its first child.
class CutLeaves {
public:
    void begin(std::size_t leaves) {
        leaves_ = leaves;
        cut_.clear();
    }
    /// Whether the leaf is as the last gradation saw it.
    bool is_old(LeafIndex leaf) const { return leaf < leaves_ && cut_.count(leaf) == 0; }
    void enter(LeafIndex leaf) { cut_.insert(leaf); }
    /// How many of so many leaves are new, children that go on with a number aside.
    std::size_t made(std::size_t leaves) const { return leaves - leaves_; }

    template <class Self, class State>
    static void exchange(Self& self, State& state) {
        state("changes.leaves", self.leaves_);
        if constexpr (std::is_const_v<Self>) {
            std::vector<LeafIndex> cut(self.cut_.begin(), self.cut_.end());
            std::sort(cut.begin(), cut.end());
            state("changes.cut", cut);
        } else {
            std::vector<LeafIndex> cut;
            state("changes.cut", cut);
            self.cut_ = {cut.begin(), cut.end()};
        }
    }

private:
    std::size_t leaves_ = 0;
    std::unordered_set<LeafIndex> cut_;
};

}  // namespace controlspace
