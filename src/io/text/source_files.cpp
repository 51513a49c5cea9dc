#include <fmt/format.h>

#include <string>

#include "controlspace/error.h"
#include "controlspace/io/read_sources.h"
#include "controlspace/io/write_vtk.h"
#include "io/text/csv.h"
#include "io/text/medit.h"
#include "io/text/msh.h"
#include "io/text/pos.h"

namespace controlspace {

namespace {

// The file beside `path` with the first of two other extensions that is there.
std::filesystem::path partner(const std::filesystem::path& path, const char* likely,
                              const char* possible) {
    std::filesystem::path other = path;
    std::error_code ignored;
    for (const char* extension : {likely, possible}) {
        if (std::filesystem::exists(other.replace_extension(extension), ignored)) return other;
    }
    throw InputError(fmt::format("{} is missing: {} needs it beside it",
                                 other.replace_extension(likely).string(), path.string()));
}

}  // namespace

std::string lower_case(std::string text) {
    for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 'a' - 'A') : c;
    return text;
}

std::string lower_case_extension(const std::filesystem::path& path) {
    return lower_case(path.extension().string());
}

std::vector<PointSource> read_sources(const std::filesystem::path& path, const std::string& array) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) {
        throw InputError(fmt::format("{}: no such file", path.string()));
    }
    if (std::filesystem::is_directory(path, ignored)) {
        throw InputError(fmt::format("{} is a directory: name a file", path.string()));
    }
    const std::string extension = lower_case_extension(path);
    if (extension == ".csv") return read_csv_sources(path);
    if (extension == ".mesh") return read_medit_sources(path, partner(path, ".sol", ".solb"));
    if (extension == ".sol") return read_medit_sources(partner(path, ".mesh", ".meshb"), path);
    if (extension == ".meshb") return read_medit_sources(path, partner(path, ".solb", ".sol"));
    if (extension == ".solb") return read_medit_sources(partner(path, ".meshb", ".mesh"), path);
    if (extension == ".pos") return read_pos_sources(path, array);
    if (extension == ".msh") return read_msh_sources(path, array);
    // A pipe, as of <(command), has a name that says nothing.
    if (path == "/dev/stdin" || !std::filesystem::is_regular_file(path, ignored)) {
        return read_csv_sources(path);
    }
    throw InputError(
        fmt::format("{}: name a .csv, a .mesh beside a .sol, a .pos or a .msh", path.string()));
}

std::string place_of_source(const std::filesystem::path& path, std::size_t index) {
    std::error_code ignored;
    if (lower_case_extension(path) == ".csv" && std::filesystem::is_regular_file(path, ignored)) {
        return fmt::format("line {}", csv_line_of(path, index));
    }
    return fmt::format("number {}", index + 1);
}

void write_sources(const std::filesystem::path& path, std::span<const PointSource> sources) {
    const std::string extension = lower_case_extension(path);
    if (extension == ".csv" || path == "/dev/stdout") return write_csv_sources(path, sources);
    if (extension == ".pos") return write_pos_sources(path, sources);
    if (extension == ".vtu" || extension == ".vtp") return write_vtk_sources(path, sources);
    if (extension == ".mesh" || extension == ".sol" || extension == ".meshb" ||
        extension == ".solb") {
        return write_medit_sources(path, sources);
    }
    throw InputError(fmt::format(
        "{}: name a .csv, .mesh, .sol, .meshb, .solb, .pos, .vtu or .vtp to write", path.string()));
}

}  // namespace controlspace
