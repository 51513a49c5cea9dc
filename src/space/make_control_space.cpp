// SPDX-License-Identifier: Apache-2.0
#include "controlspace/space/make_control_space.h"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "controlspace/input_errors.h"
#include "files/text_file.h"

namespace controlspace {

const CatalogueEntry& entry_named(std::span<const CatalogueEntry> entries, std::string_view id) {
    if (const CatalogueEntry* entry = find_entry(entries, id)) return *entry;
    std::string ids;
    for (const CatalogueEntry& entry : entries) {
        ids.append(ids.empty() ? "" : ", ").append(entry.id);
    }
    throw UnknownStructure(fmt::format("there is no structure {}: give one of {}", quote(id), ids));
}

BuildOptions to_be_read(const CatalogueEntry& entry, const SpaceOptions& options) {
    if (!entry.has<CompactForm>() || options.takes_later_sources) return {};
    return {.precision = Precision::doubles};
}

std::unique_ptr<ControlSpaceBuilder> make_filled_builder(const CatalogueEntry& entry,
                                                         std::span<const PointSource> sources,
                                                         SpaceOptions options,
                                                         std::optional<double> target,
                                                         AdaptationReport* report) {
    for (std::size_t i = 0; i < sources.size(); ++i) require_valid(sources[i], i, options.domain);
    if (options.finest_length == 0 && !sources.empty()) {
        options.finest_length = finest_length(sources);
    }
    auto builder = entry.make(options);
    AdaptationReport adapted;
    if (target) {
        adapted = builder->adapt({.sources = sources,
                                  .continuous = nullptr,
                                  .ratio = options.ratio,
                                  .target = *target,
                                  .intersection = options.intersection,
                                  .h_max = options.h_max});
    } else {
        builder->insert(sources);
        builder->grade({.ratio = options.ratio});
    }
    if (report != nullptr) *report = adapted;
    return builder;
}

std::unique_ptr<ControlSpace> make_control_space(std::span<const CatalogueEntry> entries,
                                                 std::string_view id,
                                                 std::span<const PointSource> sources,
                                                 const SpaceOptions& options,
                                                 std::optional<double> target,
                                                 AdaptationReport* report) {
    const CatalogueEntry& entry = entry_named(entries, id);
    return make_filled_builder(entry, sources, options, target, report)
        ->build(to_be_read(entry, options));
}

std::unique_ptr<ControlSpace> make_control_space(std::string_view id,
                                                 std::span<const PointSource> sources,
                                                 const SpaceOptions& options,
                                                 std::optional<double> target,
                                                 AdaptationReport* report) {
    return make_control_space(all_trees(), id, sources, options, target, report);
}

}  // namespace controlspace
