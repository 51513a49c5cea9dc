// SPDX-License-Identifier: Apache-2.0
#include "controlspace/space/catalogue.h"

#include <algorithm>

#include "space/saved.h"

namespace controlspace {

std::unique_ptr<ControlSpaceBuilder> CatalogueEntry::make(const SpaceOptions& options) const {
    auto builder = construct(options);
    if (auto* saved = dynamic_cast<Saved*>(builder.get())) saved->set_recipe(Recipe{id, options});
    return builder;
}

const CatalogueEntry* find_entry(std::span<const CatalogueEntry> entries, std::string_view id) {
    const auto named = [&](const CatalogueEntry& entry) {
        return entry.id == id || (!id.empty() && entry.former_id == id);
    };
    const auto found = std::find_if(entries.begin(), entries.end(), named);
    return found == entries.end() ? nullptr : &*found;
}

}  // namespace controlspace
