// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

namespace controlspace {

class Options;

/// The work of a command, to be called with the command line once it is parsed. Returns the exit
/// status, and throws InputError for what cannot be done.
using Action = std::function<int(const std::string& command_line)>;

/// Exit status where some cases failed or missed a requested target: results are written, and say
/// why.
inline constexpr int some_failed = 3;

// Each adds the options of one command, and returns its work. The options must live until then.
Action add_build(Options& options);
Action add_compare(Options& options);
Action add_convert(Options& options);
Action add_export(Options& options);
Action add_info(Options& options);
Action add_list(Options& options);
Action add_mesh(Options& options);
Action add_query(Options& options);

}  // namespace controlspace
