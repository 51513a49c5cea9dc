#include "sources/read_sources.h"

#include <fmt/format.h>

#include <string>

#include "error.h"
#include "sources/csv.h"
#include "sources/medit.h"

namespace controlspace {

namespace {

std::string lower_case_extension(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 'a' - 'A') : c;
    return extension;
}

// The file beside `path` with another extension.
std::filesystem::path partner(const std::filesystem::path& path, const char* extension) {
    std::filesystem::path other = path;
    other.replace_extension(extension);
    std::error_code ignored;
    if (!std::filesystem::exists(other, ignored)) {
        throw InputError(
            fmt::format("{} is missing: {} needs it beside it", other.string(), path.string()));
    }
    return other;
}

}  // namespace

std::vector<PointSource> read_sources(const std::filesystem::path& path) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) {
        throw InputError(fmt::format("{}: no such file", path.string()));
    }
    if (std::filesystem::is_directory(path, ignored)) {
        throw InputError(fmt::format("{} is a directory: name a file", path.string()));
    }
    const std::string extension = lower_case_extension(path);
    if (extension == ".csv") return read_csv_sources(path);
    if (extension == ".mesh") return read_medit_sources(path, partner(path, ".sol"));
    if (extension == ".sol") return read_medit_sources(partner(path, ".mesh"), path);
    if (extension == ".meshb" || extension == ".solb") {
        throw InputError(
            fmt::format("{} is binary Medit: convert it to .mesh and .sol", path.string()));
    }
    // A pipe, as of <(command), has a name that says nothing.
    if (!std::filesystem::is_regular_file(path, ignored)) return read_csv_sources(path);
    throw InputError(fmt::format("{}: name a .csv, or a .mesh beside a .sol", path.string()));
}

}  // namespace controlspace
