// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <optional>
#include <string>

#include "controlspace/error.h"
#include "controlspace/io/read_sources.h"
#include "controlspace/io/write_vtk.h"
#include "files/text_file.h"
#include "io/text/csv.h"
#include "io/text/medit.h"
#include "io/text/msh.h"
#include "io/text/npy.h"
#include "io/text/pos.h"
#include "refuse.h"

namespace controlspace {

namespace {

// The file beside `path` with the first of two other extensions that is there.
std::optional<std::filesystem::path> file_beside(const std::filesystem::path& path,
                                                 const char* likely, const char* possible) {
    std::filesystem::path other = path;
    std::error_code ignored;
    for (const char* extension : {likely, possible}) {
        if (std::filesystem::exists(other.replace_extension(extension), ignored)) return other;
    }
    return std::nullopt;
}

// The mesh of a solution.
std::filesystem::path mesh_of(const std::filesystem::path& path, const char* likely,
                              const char* possible) {
    if (const auto mesh = file_beside(path, likely, possible)) return *mesh;
    refuse("{} is missing: {} needs it beside it",
           std::filesystem::path(path).replace_extension(likely).string(), path.string());
}

// Sources at all vertices of a mesh that has a solution, or those of its required edges.
std::vector<PointSource> read_medit_mesh(const std::filesystem::path& mesh, const char* likely,
                                         const char* possible) {
    if (const auto solution = file_beside(mesh, likely, possible)) {
        return read_medit_sources(mesh, *solution);
    }
    try {
        return read_medit_required_edges(mesh);
    } catch (const InputError& error) {
        refuse("{} is missing, and the mesh has no lengths of its own: {}",
               std::filesystem::path(mesh).replace_extension(likely).string(), error.what());
    }
}

}  // namespace

std::string lower_case_extension(const std::filesystem::path& path) {
    return lower_case(path.extension().string());
}

std::vector<PointSource> read_sources(const std::filesystem::path& path,
                                      const ReadOptions& options) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) refuse_at(path, "no such file");
    if (std::filesystem::is_directory(path, ignored)) {
        refuse("{} is a directory: name a file", path.string());
    }
    const std::string extension = lower_case_extension(path);
    if (extension == ".csv") return read_csv_sources(path, options);
    if (extension == ".npy") return read_npy_sources(path);
    if (extension == ".mesh") return read_medit_mesh(path, ".sol", ".solb");
    if (extension == ".sol") return read_medit_sources(mesh_of(path, ".mesh", ".meshb"), path);
    if (extension == ".meshb") return read_medit_mesh(path, ".solb", ".sol");
    if (extension == ".solb") return read_medit_sources(mesh_of(path, ".meshb", ".mesh"), path);
    if (extension == ".pos") return read_pos_sources(path, options);
    if (extension == ".msh") return read_msh_sources(path, options);
    // A pipe, as of <(command), has a name that says nothing.
    if (path == "/dev/stdin" || !std::filesystem::is_regular_file(path, ignored)) {
        return read_csv_sources(path, options);
    }
    refuse_at(path, "name a .csv, a .npy, a .mesh beside a .sol, a .pos or a .msh");
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
    const auto grows_alone = [](const PointSource& source) { return source.growth != 0; };
    if (std::ranges::any_of(sources, grows_alone)) {
        refuse_at(path, "only a .csv holds gradation ratios of sources: name one");
    }
    if (extension == ".pos") return write_pos_sources(path, sources);
    if (extension == ".vtu" || extension == ".vtp") return write_vtk_sources(path, sources);
    if (extension == ".mesh" || extension == ".sol" || extension == ".meshb" ||
        extension == ".solb") {
        return write_medit_sources(path, sources);
    }
    refuse_at(path, "name a .csv, .mesh, .sol, .meshb, .solb, .pos, .vtu or .vtp to write");
}

}  // namespace controlspace
