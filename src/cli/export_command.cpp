#include "cli/export_command.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "controlspace/error.h"
#include "controlspace/io/read_sources.h"
#ifdef CONTROLSPACE_OPENVDB
#include "controlspace/io/metric_grids.h"
#endif

namespace controlspace {
namespace {

#ifdef CONTROLSPACE_OPENVDB
void add_vdb_options(CLI::App& command, ExportOptions& options) {
    const std::string file = "A .vdb file";
    command
        .add_option("--voxel", options.vdb.voxel,
                    "Edge of a voxel [length]; left out: 1/128 of the longest edge of the domain")
        ->option_text("NUMBER")
        ->group(file);
    command
        .add_option("--tolerance", options.vdb.tolerance,
                    "Non-conformity within which voxels share a metric; 0: only where it is the "
                    "same (default: 0.02)")
        ->option_text("NUMBER")
        ->group(file);
    std::string names;
    for (const MetricGrid& grid : metric_grids()) names += fmt::format("{}, ", grid.name);
    command
        .add_option("--grids", options.vdb.grids,
                    fmt::format("Some of {}and {}, the points (left out: all but these)", names,
                                sources_grid))
        ->option_text("TEXT,...")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->group(file);
    command
        .add_option("--compression", options.vdb.compression, "blosc, zip or none (default: blosc)")
        ->option_text("TEXT")
        ->transform(
            CLI::Transformer(std::map<std::string, VdbCompression>{{"blosc", VdbCompression::blosc},
                                                                   {"zip", VdbCompression::zip},
                                                                   {"none", VdbCompression::none}}))
        ->group(file);
    command.add_flag("--half", options.vdb.half, "Numbers of 16 bits")->group(file);
}
#endif

#ifdef CONTROLSPACE_VTK
void add_vtk_options(CLI::App& command, ExportOptions& options) {
    const std::string file = "A .vtu or .vti file";
    command.add_flag("--nodes", options.nodes, ".vtu: the control nodes in place of the leaves")
        ->group(file);
    command
        .add_option("--slice", options.slice,
                    ".vti: x, y or z, and where on that axis; left out: z, and the middle")
        ->option_text("AXIS [NUMBER]")
        ->expected(1, 2)
        ->group(file);
    command
        .add_option(
            "--samples", options.samples,
            fmt::format(".vti: places along the longer edge (default: {})", options.samples))
        ->option_text("COUNT")
        ->group(file);
}
#endif

/// Refuses options of formats other than that of `output`.
void require_of_format(const CLI::App& command, const std::filesystem::path& output) {
    const std::vector<std::string> solution{".sol", ".solb"}, image{".vti"}, grid{".vtu"},
        volume{".vdb"};
    const std::map<std::string, std::vector<std::string>> formats{
        {"--mesh", solution}, {"--nodes", grid},   {"--slice", image},
        {"--samples", image}, {"--voxel", volume}, {"--tolerance", volume},
        {"--grids", volume},  {"--half", volume},  {"--compression", volume}};
    const std::string ending = lower_case_extension(output);
    for (const CLI::Option* option : command.get_options()) {
        const auto of = formats.find(option->get_name());
        if (option->count() == 0 || of == formats.end()) continue;
        if (std::find(of->second.begin(), of->second.end(), ending) != of->second.end()) continue;
        throw InputError(
            fmt::format("{} is for {}: leave it out", of->first, fmt::join(of->second, " and ")));
    }
}

}  // namespace

CLI::App* add_export(CLI::App& app, ExportOptions& options, WordsByKey& given) {
    CLI::App* command = app.add_subcommand(
        "export",
        "Write the field of one structure to a file, for Blender, Houdini, ParaView or a mesher");
    add_filled_input(*command, options.input);
    command
        ->add_option("-o,--output", options.output,
                     "File to write, of a format by its ending: " + exported_formats())
        ->option_text("FILE")
        ->required();
    command
        ->add_option("--mesh", options.mesh,
                     ".sol, .solb: the mesh (.mesh, .meshb) at whose vertices the field is taken")
        ->option_text("FILE");
#ifdef CONTROLSPACE_OPENVDB
    add_vdb_options(*command, options);
#endif
#ifdef CONTROLSPACE_VTK
    add_vtk_options(*command, options);
#endif
    // --voxel is the file's, not that of a grid that is exported.
    add_making_options(*command, given, "voxel");
    command->add_flag("--quiet", options.quiet, "No progress on standard error");
    command->callback([command, &options] {
        require_of_format(*command, options.output);
#ifdef CONTROLSPACE_OPENVDB
        options.with_sources = std::erase(options.vdb.grids, sources_grid) > 0;
#endif
    });
    return command;
}

}  // namespace controlspace
