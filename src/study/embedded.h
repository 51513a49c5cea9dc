#pragma once

#include <string_view>

namespace controlspace {

/// The study of the paper's sphere at rho = tau = 1, in both modes; the text of
/// data/studies/paper-sphere-quick.toml.
std::string_view quick_study_text();

}  // namespace controlspace
