#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace controlspace {

/// What the command line of `paper` asks for.
struct PaperOptions {
    /// Folders of results, or one study file; none: the built-in studies.
    std::vector<std::filesystem::path> inputs;
    bool full = false;             ///< built-in studies: the denser sources too
    std::filesystem::path output;  ///< new folder for results; empty: as the study says
    bool quiet = false;
    std::string command_line;
};

/// Sets our values beside the paper's: runs what it needs, or reads results that are there. Prints
/// the summary and writes paper.md into the folder of results, the first one if there are several.
/// Throws InputError.
void paper(const PaperOptions& options);

}  // namespace controlspace
