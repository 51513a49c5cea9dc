// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <vector>

#include "cli/given_settings.h"
#include "controlspace/sources/point_source.h"
#include "controlspace/study/study.h"
#include "controlspace/study/workload.h"

namespace controlspace {

/// Sets the sources to `input`: a file, or, where there is none of this name, what `--sources`
/// takes (sphere; a.csv,b.stl). Throws InputError for a word that is neither.
void set_sources(Study& study, const std::filesystem::path& input);

/// The same, unless `input` is empty, and the settings given; sources that these name are added to
/// those of `input`.
void apply_with_input(const std::filesystem::path& input, const GivenSettings& given, Study& study);

/// The files that are read for `input`: sources (see set_sources), or a study file.
std::vector<std::filesystem::path> files_named(const std::filesystem::path& input);

/// The study of `input`, a study file (.toml) or sources (see set_sources), with the settings
/// given. Without a study file: the structure K_oV, and the cut s_L for kd-trees; without an input:
/// on the paper's sphere. Throws InputError.
Study study_of_input(const std::filesystem::path& input, const GivenSettings& given);

/// Whether one of the keys is given.
bool are_given(const GivenSettings& given, std::initializer_list<const char*> keys);

/// The largest factor between lengths that trees are adapted to by default.
double default_within_of(const Workload& workload);

/// The target of K_oV, of what a .vdb can hold, and of what follows primitives or another field,
/// where neither a study file nor a setting says how it is made: lengths within 1.1x of the exact
/// field's; with tensors 1.2x, or as near as 50000 leaves come, which is a target missed.
class DefaultTarget {
public:
    DefaultTarget(const std::filesystem::path& input, const GivenSettings& given);
    void set(Case& c, const Workload& workload) const;

private:
    bool is_free_;  ///< whether no target is given
    bool applies_;
    std::optional<std::size_t> max_leaves_;  ///< given without a target; 0: no limit
};

/// The one case of a study that makes one structure. Throws InputError where it has more.
Case only_case(const Study& study);

/// The sources of a file of any supported format, or of another value of `--sources`; `given` are
/// settings of a study for reading. Throws InputError.
std::vector<PointSource> sources_of_input(const std::filesystem::path& input,
                                          const GivenSettings& given);

/// Throws InputError if `output`, unless empty, is one of the files that are read, or cannot be
/// written. A Medit mesh and its solution are read and written together.
void require_output(const std::filesystem::path& output,
                    const std::vector<std::filesystem::path>& inputs);

/// Throws InputError where voxels are to be chosen by trial, which only `compare` does.
void require_set_voxels(const Case& c);

}  // namespace controlspace
