// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "controlspace/study/measure.h"
#include "controlspace/study/study.h"
#include "controlspace/study/workload.h"

namespace controlspace {

/// Notifications of a running study; each function may be empty.
struct StudyObserver {
    std::function<void(const Case&)> case_started;
    std::function<void(std::string_view)> phase_started;  ///< within a case: "insertion"
    /// A structure is finished and checked, but not timed yet; the row may be extended.
    std::function<void(const Finished&, Row&)> case_checked;
    std::function<void(const Row&)> case_finished;  ///< in the order of the cases
};

/// A study that is ready to run: all cases are checked, all sources are in memory.
class PreparedStudy {
public:
    /// Leaves out the first `finished` cases. Throws InputError for a study that cannot be run. The
    /// rows must outlive it.
    PreparedStudy(Study study, const StudyRows& rows, const FileReaders& readers = {},
                  std::size_t finished = 0);

    const Study& study() const { return study_; }
    const StudyRows& rows() const { return rows_; }
    std::span<const Case> cases() const { return cases_; }
    /// The structure of a case, and its sources until `run` has freed them.
    const CatalogueEntry& entry(const Case& c) const;
    const Workload& workload(const Case& c) const { return sources_of(c).workload; }
    /// Number of sources of each case.
    std::span<const std::size_t> source_counts() const { return source_counts_; }

    /// Runs the cases. Each structure is made creation_repeats times and checked, one after the
    /// other, so that none disturbs the timing of another. Finished structures of consecutive cases
    /// with the same sources and reference form a batch, within half of max_memory, whose access is
    /// timed in turns. A time is reported only for answers that were checked. A case that fails
    /// gives a row with the reason. Sources and probes are freed after the last case that needs
    /// them; hence a study runs once.
    void run(const StudyObserver& observer) &&;
    /// The same, for the rows of all cases, in their order.
    std::vector<Row> run() &&;

private:
    struct SharedSources {
        SourcesChoice choice;
        Workload workload;
        std::size_t last_use = 0;  ///< index of a case
    };

    const SharedSources& sources_of(const Case& c) const;
    SharedSources& sources_of(const Case& c);

    Study study_;
    StudyRows rows_;
    std::size_t finished_;  ///< cases that came before
    std::vector<Case> cases_;
    std::vector<SharedSources> sources_;
    std::vector<std::size_t> source_counts_;
};

/// The cases whose probes are the same: same sources, same reference, same g_r.
bool share_probes(const Case& a, const Case& b);

/// The entry of the structure of `c`, which `expand` has found in `catalogue`.
const CatalogueEntry& entry_of(const Case& c, std::span<const CatalogueEntry> catalogue);

/// Limits that end the making of a structure: those of trees; a grid is made coarser than wanted to
/// keep `growth.bytes`.
struct RowLimits {
    GrowthLimit growth;
    /// "60 s", "20 times the memory of the smallest row", for texts.
    std::string time, memory;

    /// "at 60 s"; `max_leaves`: of the goal, where these stopped it.
    std::string place_of(GrowthStop stop, std::size_t max_leaves = 0) const;
};

/// A builder with the sources of a case inserted, graded or adapted, and what it has built, in the
/// precision of the case. Exceptions pass through.
struct Filled {
    std::unique_ptr<ControlSpaceBuilder> builder;
    std::unique_ptr<ControlSpace> space;
    Creation creation;  ///< of the space
};
Filled make_and_fill(const Study& study, const Case& c, const StudyRows& rows,
                     const Workload& workload, const StudyObserver& observer = {},
                     const RowLimits& limits = {});

}  // namespace controlspace
