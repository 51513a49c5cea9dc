#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "controlspace/geometry/box.h"
#include "controlspace/space/catalogue.h"
#include "study/case.h"

namespace controlspace {

/// Lists of values whose product gives cases. Values that do not concern a structure (a split of an
/// octree, a depth of a grid) do not multiply it.
struct Run {
    /// Ids, or the groups "all", "trees", "anchored" and "baselines".
    std::vector<std::string> structures{"all"};
    std::vector<SplitRule> splits{SplitRule::middle, SplitRule::golden, SplitRule::metric};
    std::vector<double> rho{1};
    std::vector<double> tau{1};
    std::vector<double> epsilon{0.2};
    std::vector<double> g_r{1.25};
    std::vector<double> s_a{2};
    std::vector<double> s_n{1};
    std::vector<Sampling> sampling{Sampling::regular};
    std::vector<FieldKind> field{FieldKind::none};
    std::vector<int> kd_depth{42};
    std::vector<int> octree_depth{14};
    std::vector<double> voxel{0};  ///< 0: by tau and the smallest length that is asked for
    std::vector<double> voxel_factor{1};
    std::vector<double> prune_delta{0};   ///< 0: no pruning
    std::vector<double> target_delta{0};  ///< 0: no adaptation
    std::vector<double> equal_delta{0};   ///< 0: voxels as they are set
    std::vector<double> equal_memory{0};  ///< [MB]; 0: voxels as they are set
    std::vector<NodeValues> node_values{NodeValues::graded};
    std::vector<Frozen> frozen{Frozen::no};
    std::vector<GradationLaw> law{GradationLaw::cone};
    std::vector<GradationSchedule> schedule{GradationSchedule::queue};
    std::vector<Neighbourhood> neighbourhood{Neighbourhood::faces};
    std::vector<ReferenceKind> reference{ReferenceKind::exact};
};

/// A comparison: one kind of sources, one domain, one way to measure, and the runs.
struct Study {
    std::string name = "study";
    SourcesChoice sources;  ///< sampling, rho, s_a, s_n and the kind of field come from the runs
    /// None: where the field is defined; where that is everywhere, and for sampled surfaces,
    /// [-1, 1]^3; else from the sources.
    std::optional<Box> domain;
    double margin = 0.05;       ///< around sources from a file, in units of their longest extent
    double max_memory_gib = 4;  ///< cap on a structure
    std::uint64_t seed = 1;     ///< of the random places that access is timed at, and of sources
    int threads = 0;            ///< of all but the access, which is timed on one; 0: all
    std::size_t access_points = 100000;  ///< random places
    int access_repeats = 9;
    int probe_grid = 30;        ///< n of the n^3 cell centres for δ_R, and for access in order
    int fine_probe_grid = 101;  ///< n of the finer ones
    double reference_tolerance = 0;  ///< of the exact reference, see cones/cone_field.h
    std::string output;              ///< folder; empty: results/NAME-DATE-TIME
    std::vector<Run> runs{1};
};

/// All cases of a study, each once, in the order of the runs; within a run structures vary fastest,
/// then splits, then tau; the field is outermost. Throws InputError for a structure that
/// `catalogue` does not know, for sampling parameters that differ from their defaults where nothing
/// is sampled, for a reference that does not fit the sources, and for a study without cases.
std::vector<Case> expand(const Study& study, std::span<const CatalogueEntry> catalogue);

}  // namespace controlspace
