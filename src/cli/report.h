#pragma once

#include <filesystem>
#include <vector>

namespace controlspace {

/// What the command line of `report` asks for.
struct ReportOptions {
    std::vector<std::filesystem::path> inputs;  ///< folders of results, one or more
    std::filesystem::path output;               ///< folder; empty: the first input
    bool without_fields = false;                ///< no structure is made again
};

/// Writes report.html and its pictures. Throws InputError.
void report(const ReportOptions& options);

}  // namespace controlspace
