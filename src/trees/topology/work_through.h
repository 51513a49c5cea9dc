// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace controlspace {

/// Calls work(item, next) for `first` and for every item that such a call passes to next(item): a
/// traversal of a tree, parents before children and in no further order. On all of TBB's threads,
/// and on each some items side by side, so that what `work` prefetches for an item has arrived when
/// its turn comes.
template <class Item, class Work>
void work_through(const Item& first, const Work& work) {
    constexpr std::size_t enough_shares = 256;
    std::vector<Item> shares{first};
    std::vector<Item> next_shares;
    while (!shares.empty() && shares.size() < enough_shares) {
        next_shares.clear();
        for (const Item& item : shares) {
            work(item, [&](const Item& next) { next_shares.push_back(next); });
        }
        shares.swap(next_shares);
    }
    tbb::parallel_for(std::size_t{0}, shares.size(), [&](std::size_t share) {
        constexpr std::size_t most_together = 16;
        std::array<Item, most_together> together;
        std::vector<Item> waiting{shares[share]};
        while (!waiting.empty()) {
            const std::size_t n = std::min(waiting.size(), most_together);
            std::copy_n(waiting.end() - static_cast<std::ptrdiff_t>(n), n, together.begin());
            waiting.resize(waiting.size() - n);
            for (std::size_t i = 0; i < n; ++i) {
                work(together[i], [&](const Item& next) { waiting.push_back(next); });
            }
        }
    });
}

}  // namespace controlspace
