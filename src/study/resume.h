#pragma once

#include <span>
#include <vector>

#include "study/read_results.h"

namespace controlspace {

/// The rows that an interrupted run of `study` left behind: those of its first cases, in order.
/// Throws InputError where going on would mix what must not be mixed: results that are complete, of
/// another study or other settings, or made by another build or on another processor.
std::vector<Row> rows_to_go_on_from(const StoredResults& earlier, const Study& study,
                                    std::span<const Case> cases, const Provenance& now);

}  // namespace controlspace
