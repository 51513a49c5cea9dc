// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace controlspace {

/// The items with equal keys together, groups in the order of their first items.
template <class Item, class Key>
std::vector<std::pair<std::string, std::vector<const Item*>>> grouped(std::span<const Item> items,
                                                                      const Key& key_of) {
    std::vector<std::pair<std::string, std::vector<const Item*>>> groups;
    for (const Item& item : items) {
        const std::string key = key_of(item);
        auto group =
            std::ranges::find_if(groups, [&](const auto& known) { return known.first == key; });
        if (group == groups.end()) group = groups.insert(group, {key, {}});
        group->second.push_back(&item);
    }
    return groups;
}

}  // namespace controlspace
