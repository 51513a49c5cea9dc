#pragma once

#include <tbb/global_control.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "cli/given_settings.h"
#include "controlspace/space/control_space.h"
#include "controlspace/space/control_space_builder.h"
#include "controlspace/study/run.h"

namespace controlspace {

/// What a structure was made for.
struct Origin {
    Study study;
    Case c;
    Workload workload;
};

struct FilledSpace {
    std::unique_ptr<ControlSpaceBuilder> builder;  ///< none of a compact form that was loaded
    std::unique_ptr<ControlSpace> space;
    std::string structure;                         ///< id in the catalogue
    std::optional<Origin> origin;                  ///< none of a control space that was loaded
    std::unique_ptr<tbb::global_control> threads;  ///< the study's limit, as long as this lives
};

/// Whether the file is a control space that was saved (.ctrl).
bool is_control_space(const std::filesystem::path& input);

/// Throws InputError, naming the first, where settings are given with a control space that was
/// saved.
void require_no_settings(const std::filesystem::path& space, const GivenSettings& given);

/// The one structure that `input` (as study_of_input has it) and the settings ask for, made and
/// graded; or, of a .ctrl, loaded. Throws InputError, also where a .ctrl is given with settings: it
/// is as it is.
/// `observer` is told of the steps.
FilledSpace filled_space(const std::filesystem::path& input, const GivenSettings& given,
                         const StudyObserver& observer);

}  // namespace controlspace
