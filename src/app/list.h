#pragma once

#include <string>

namespace controlspace {

/// Text of `controlspace list`: structures, splits, laws, schedules and references.
std::string list_text();

}  // namespace controlspace
