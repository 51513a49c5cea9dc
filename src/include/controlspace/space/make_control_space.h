// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "controlspace/space/catalogue.h"

namespace controlspace {

/// The entry that is named `id`, or once was. Throws UnknownStructure, which lists the ids.
const CatalogueEntry& entry_named(std::span<const CatalogueEntry> entries, std::string_view id);

/// Builds the field of point sources, in one step; never null.
///
/// `id`: a tree (tree_catalogue, anchored_catalogue), or one of `entries`: those of structures()
/// are all. `options`: its `ratio` is the gradation ratio of the sources; a finest_length of 0
/// becomes theirs. `target`: with one, the structure is adapted to the exact field until δ,
/// and of tensors k + 1/k − 2 along each direction, is at most that, which `report`, unless null,
/// says whether it was reached; without one, sources are inserted and graded, which is faster and
/// less accurate. It is built as `to_be_read` says.
///
/// Throws UnknownStructure, IndexedError for a source that cannot be used, MemoryLimitError where
/// the structure would outgrow options.max_bytes, and InputError for options out of range.
std::unique_ptr<ControlSpace> make_control_space(std::string_view id,
                                                 std::span<const PointSource> sources,
                                                 const SpaceOptions& options,
                                                 std::optional<double> target = {},
                                                 AdaptationReport* report = nullptr);
std::unique_ptr<ControlSpace> make_control_space(std::span<const CatalogueEntry> entries,
                                                 std::string_view id,
                                                 std::span<const PointSource> sources,
                                                 const SpaceOptions& options,
                                                 std::optional<double> target = {},
                                                 AdaptationReport* report = nullptr);

/// How a control space is built that is only read from then on: in doubles,
/// if it has a choice, unless options.takes_later_sources. It answers the same bits in less time,
/// and takes less memory where all is isotropic.
BuildOptions to_be_read(const CatalogueEntry& entry, const SpaceOptions& options);

/// The same, for more sources to come: the builder, filled. With options.takes_later_sources they
/// may come after this gradation, too. Throws as make_control_space.
std::unique_ptr<ControlSpaceBuilder> make_filled_builder(const CatalogueEntry& entry,
                                                         std::span<const PointSource> sources,
                                                         SpaceOptions options,
                                                         std::optional<double> target = {},
                                                         AdaptationReport* report = nullptr);

}  // namespace controlspace
