#pragma once

#include <string>

namespace controlspace {

/// Text of `controlspace list`: the names that settings take, and what they stand for.
std::string list_text();

}  // namespace controlspace
