#pragma once

#include <filesystem>

#include "app/given_settings.h"
#include "study/case.h"
#include "study/study.h"

namespace controlspace {

/// The study that `input`, a study file (.toml) or a file of sources, and the settings given ask
/// for. Without a study file: the structure K_oL, and the cut s_L for kd-trees; without a file at
/// all: on the paper's sphere. Throws InputError.
Study study_of_input(const std::filesystem::path& input, const GivenSettings& given);

/// Throws InputError where voxels are to be found by trial, which `compare` alone does.
void require_set_voxels(const Case& c);

}  // namespace controlspace
