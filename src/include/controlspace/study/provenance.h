// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace controlspace {

/// Which program made a file of results, where and when.
struct Provenance {
    std::string version;   ///< of the program
    std::string commit;    ///< of the source; "unknown" without git
    bool dirty = false;    ///< tracked files differed from the commit
    std::string compiler;  ///< name and version
    std::string flags;
    std::string cpu;          ///< model; "unknown" where the system does not provide it
    unsigned cores = 0;       ///< that the system offers
    std::size_t threads = 0;  ///< of all but the access, which is timed on one
    std::string date;         ///< UTC, "2024-05-01T12:00:00Z"
    std::string command_line;
};

/// All but the command line, as of now.
Provenance current_provenance();

/// "0.1.0 (commit 1234567, modified)".
std::string version_text(const Provenance& provenance);

}  // namespace controlspace
