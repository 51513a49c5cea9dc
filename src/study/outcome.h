// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "controlspace/study/measure.h"
#include "controlspace/study/study.h"
#include "study/results_json.h"

namespace controlspace {

/// Which structures of the same work to take within an error: indices of rows, several where they
/// are indistinguishable.
struct Outcome {
    std::string work = {};
    double factor = 1.25;      ///< by which a length may differ from the reference's at all probes
    bool is_asked = false;     ///< `factor` is that of a target of the study; otherwise the default
    std::size_t measured = 0;  ///< rows of this work
    std::vector<std::size_t> within = {};  ///< those of them within `factor`
    std::vector<std::size_t> smallest = {};
    /// At random places: all whose quartiles overlap with those of the smallest median, by rising
    /// medians. Empty where the rows within were not timed in turns.
    std::vector<std::size_t> fastest = {};
    std::vector<std::size_t> most_accurate = {};
    /// The same in words, each a sentence: how many are within, and one for each wish; or that none
    /// is within, which is closest, and what to do.
    std::vector<std::string> sentences = {};
};

/// For every work with measured rows, one for each target that was requested there (target_delta,
/// within), else one for 1.25.
std::vector<Outcome> outcomes(std::span<const Row> rows, const StudyRows& columns);

/// The sentences, under the names of the works where there are several; empty without outcomes.
std::string outcome_text(std::span<const Row> rows, const StudyRows& columns);

Json to_json(const Outcome& outcome);

}  // namespace controlspace
