#pragma once

#include <filesystem>
#include <string_view>

#include "study/study.h"

namespace controlspace {

/// Reads a study file (TOML). Keys of `study_settings` stand at the top; keys of `run_settings` in
/// tables [[runs]], or at the top for all runs that do not set them. A value may stand alone or in
/// an array; arrays of a run expand to the product of cases. A file of sources is looked for beside
/// the study file. Without a name the study is called as its file.
///
/// Throws InputError "FILE:LINE: ..." for what is not TOML, unknown keys, and values of a wrong
/// type, number or range.
Study read_study(const std::filesystem::path& file);

/// The same from `text`; `place` stands for the file in messages and in the paths of sources.
Study parse_study(std::string_view text, const std::filesystem::path& place);

/// The study of the paper's sphere at rho = tau = 1, in both modes; the text of
/// data/studies/paper-sphere-quick.toml.
std::string_view quick_study_text();

}  // namespace controlspace
