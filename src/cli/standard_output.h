#pragma once

#include <string_view>

namespace controlspace {

/// Keeps the places of standard input, output and error that the caller has closed from files that
/// are opened later. What is written there still fails. To be called first.
void keep_standard_places();

/// Writes `text` to standard output; throws InputError if it does not take it (a full disk).
void print(std::string_view text);

/// Writes `text` to standard error. What that does not take is lost: nobody could be told.
void print_error(std::string_view text);

}  // namespace controlspace
