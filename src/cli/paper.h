#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace controlspace {

/// What the command line of `paper` asks for.
struct PaperOptions {
    /// Folders of results, or one study file; none: the paper's tables, and the experiments.
    std::vector<std::filesystem::path> inputs;
    bool full = false;             ///< without inputs: the denser sources too
    bool experiments = false;      ///< with inputs: run the experiments too
    std::filesystem::path output;  ///< new folder for results; empty: as the study says
    bool quiet = false;
    std::string command_line;
};

/// Folders with results of experiments that lie in the folder of the cells.
std::vector<std::filesystem::path> experiments_in(const std::filesystem::path& folder);

/// Sets our values beside the paper's: runs what it needs, or reads results that are there. Prints
/// the summary and writes paper.md into the folder of results, the first one if there are several.
/// Experiments are run at the settings of that folder's cells, into folders in it. Returns whether
/// all cases were measured. Throws InputError.
bool paper(const PaperOptions& options);

}  // namespace controlspace
