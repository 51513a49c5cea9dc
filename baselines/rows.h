// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "controlspace/space/catalogue.h"

namespace controlspace {

/// Uniform Cartesian grids over the domain, their metrics in one flat array, x fastest: what a user
/// writes who wants no tree.
std::vector<CatalogueEntry> uniform_rows();

/// No structure at all: stores the sources and answers the exact field of their cones (paper §5.2,
/// cones/cone_field.h) by a search among them. Exact everywhere, but every answer is a search.
///
/// It is graded from the start, to the `ratio` of its options; `grade` only changes that ratio,
/// whatever the law and the schedule. Every source is stored, those that cannot matter being left
/// out of the search; `insert` always answers `inserted`. Control nodes are the sources, in order
/// of insertion, without neighbours: a node's metric is what its source requests, and the field at
/// its place is smaller where another source's cone is.
///
/// The search is made by `build`, on all of TBB's threads, in time in proportion to the number of
/// sources. Throws InputError for an invalid domain or ratio, and for 2^31 sources.
std::vector<CatalogueEntry> direct_rows();

}  // namespace controlspace
