// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/sandbox.h"

namespace controlspace {

/// Runs `controlspace ARGUMENTS` in a sandbox on a terminal of its own, of 200 columns, which
/// standard error goes to: `err` is all that was written there. Types Ctrl-C when `word` has come,
/// if one is given. What takes longer than a minute is ended, with status -1.
Outcome run_on_terminal(const Sandbox& box, const std::string& arguments,
                        const std::string& word = "");

}  // namespace controlspace
