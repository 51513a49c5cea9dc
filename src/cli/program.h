// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace controlspace {

/// The whole command line: reads the arguments, runs the command that they name and reports errors.
/// Returns the exit status.
int run_program(int argc, const char* const* argv);

}  // namespace controlspace
