#pragma once

#include <string_view>

namespace controlspace {

/// Writes `text` to standard output; throws InputError if it does not take it (a full disk).
void print(std::string_view text);

/// Writes `text` to standard error. What that does not take is lost: nobody could be told.
void print_error(std::string_view text);

}  // namespace controlspace
