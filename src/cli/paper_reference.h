// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "controlspace/baselines/catalogue.h"
#include "controlspace/study/study.h"

namespace controlspace {

/// The field that the paper's Table 4 was measured against, for isotropic sources of a sphere
/// around the origin: h(p) = min(H, h + s ||p| - radius|), s = 2 (g_r - 1) / (g_r + 1), where H is
/// half of the domain's diagonal.
const ReferenceKind& published_sphere();

/// The parameters of cases in this program: those of the library, with that reference.
std::span<const CaseParameter> program_parameters();

/// All structures, with these parameters.
inline StudyRows program_rows() { return {structures(), program_parameters()}; }

}  // namespace controlspace
