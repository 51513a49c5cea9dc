#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "controlspace/space/catalogue.h"
#include "study/row.h"
#include "study/study.h"
#include "study/workload.h"

namespace controlspace {

/// Told of what a study does; each may be empty.
struct StudyObserver {
    std::function<void(const Case&)> case_started;
    std::function<void(std::string_view)> phase_started;  ///< within a case: "insertion"
    std::function<void(const Row&)> case_finished;
};

/// A study made ready to run: every case checked, every set of sources at hand.
class PreparedStudy {
public:
    /// Without the `finished` cases that come first. Throws InputError for anything about the study
    /// that cannot be run.
    PreparedStudy(Study study, std::span<const CatalogueEntry> catalogue,
                  const FileReaders& readers = {}, std::size_t finished = 0);

    const Study& study() const { return study_; }
    std::span<const Case> cases() const { return cases_; }
    /// Of a case of the study: its structure, and its sources, until `run` has freed them.
    const CatalogueEntry& entry(const Case& c) const;
    const Workload& workload(const Case& c) const { return sources_of(c).workload; }
    /// Number of sources of each case.
    std::span<const std::size_t> source_counts() const { return source_counts_; }

    /// Runs the cases one after the other, so that none disturbs the timing of another. A case that
    /// fails gives a row with its reason. Sources and probes are freed after the last case that
    /// needs them, so it runs once.
    void run(const StudyObserver& observer) &&;

private:
    struct SharedSources {
        SourcesChoice choice;
        Workload workload;
        std::size_t last_use = 0;  ///< index of a case
    };

    const SharedSources& sources_of(const Case& c) const;
    SharedSources& sources_of(const Case& c);

    Study study_;
    std::span<const CatalogueEntry> catalogue_;
    std::vector<Case> cases_;
    std::vector<SharedSources> sources_;
    std::vector<std::size_t> source_counts_;
};

/// The cases whose probes are the same: same sources, same reference, same g_r.
bool share_probes(const Case& a, const Case& b);

/// The entry of the structure of `c`, which `expand` has found in `catalogue`.
const CatalogueEntry& entry_of(const Case& c, std::span<const CatalogueEntry> catalogue);

/// The builder of a structure that has got what case `c` asks for, and is graded; what that took
/// goes into `m`. Exceptions pass through.
std::unique_ptr<ControlSpaceBuilder> make_and_fill(const Study& study, const Case& c,
                                                   const CatalogueEntry& entry,
                                                   const Workload& workload, Measures& m,
                                                   const StudyObserver& observer);

/// What it builds for case `c`: the compact form where the case asks for one.
std::unique_ptr<ControlSpace> finish(ControlSpaceBuilder& builder, const Case& c);

/// Makes, grades and measures one structure. Exceptions pass through.
Measures run_case(const Study& study, const Case& c, const CatalogueEntry& entry,
                  const Workload& workload, const ReferenceProbes& probes,
                  const StudyObserver& observer);

}  // namespace controlspace
