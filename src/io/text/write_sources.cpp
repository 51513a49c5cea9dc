#include "io/text/write_sources.h"

#include <fmt/format.h>

#include <string>

#include "controlspace/error.h"
#include "controlspace/io/read_sources.h"
#include "io/text/csv.h"
#include "io/text/pos.h"
#include "io/text/write_medit_sources.h"

namespace controlspace {

void write_sources(const std::filesystem::path& path, std::span<const PointSource> sources) {
    const std::string ending = lower_case_extension(path);
    if (ending == ".csv") return write_csv_sources(path, sources);
    if (ending == ".mesh" || ending == ".sol" || ending == ".meshb" || ending == ".solb") {
        return write_medit_sources(path, sources);
    }
    if (ending == ".pos") return write_pos_sources(path, sources);
    throw InputError(
        fmt::format("{}: name a .csv, .mesh, .sol, .meshb, .solb or .pos to write", path.string()));
}

}  // namespace controlspace
