#pragma once

#include <string>

namespace controlspace {

/// Writes `text`, as much of it as fits, over the line of standard error's terminal.
void show_live_line(const std::string& text);

/// Leaves that line empty.
void clear_live_line();

}  // namespace controlspace
