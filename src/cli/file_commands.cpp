#include "cli/file_commands.h"

#include "study/file_settings.h"
#include "study/vdb_settings.h"

namespace controlspace {
namespace {

constexpr const char* formats =
    "Sources: .csv; .mesh, .sol, .meshb or .solb, the other beside it; .pos; .msh; .vtu, .vtp; or "
    "a surface: .stl, .obj, .ply, .off, or in a .vdb";

void add_reading_options(CLI::App& command, WordsByKey& given) {
    constexpr std::string_view fields[] = {"field_file", "field_grid", "field_density_sizes"};
    add_options(command, file_settings(), Study{}, "Settings of reading", given);
    add_options(command, vdb_settings(), Study{}, "Settings of reading", given, fields);
}

}  // namespace

CLI::App* add_info(CLI::App& app, InfoOptions& options, WordsByKey& given) {
    CLI::App* command = app.add_subcommand(
        "info",
        "Say what a file of sources holds (how many, their sizes, how fast they grow), or a "
        "control space");
    command
        ->add_option("FILE", options.input,
                     std::string(formats) + "; or a control space (.ctrl) that was saved")
        ->required()
        ->option_text("FILE");
    command->footer(
        "Exit status:\n"
        "  0    the file could be read, with tensors that are not positive definite too, whose "
        "share "
        "is told\n"
        "  1    the program or the system failed\n"
        "  2    the file cannot be read, or a setting does not fit");
    add_reading_options(*command, given);
    return command;
}

CLI::App* add_convert(CLI::App& app, ConvertOptions& options, WordsByKey& given) {
    CLI::App* command =
        app.add_subcommand("convert", "Write the sources of one file in another format");
    command->add_option("IN", options.input, formats)->required()->option_text("FILE");
    command
        ->add_option("OUT", options.output,
                     "File to write: .csv; .mesh, .sol, .meshb or .solb, which makes both a mesh "
                     "and a solution; .pos; .vtu, .vtp")
        ->required()
        ->option_text("FILE");
    add_reading_options(*command, given);
    return command;
}

CLI::App* add_build(CLI::App& app, BuildOptions& options, WordsByKey& given) {
    CLI::App* command = app.add_subcommand(
        "build", "Make and grade one structure, and save it, for other commands and programs");
    add_study_input(*command, options.input);
    command->add_option("-o,--output", options.output, "File to write")
        ->required()
        ->option_text("FILE.ctrl");
    add_making_options(*command, given);
    command->add_flag("--quiet", options.quiet, "No progress on standard error");
    return command;
}

CLI::App* add_query(CLI::App& app, QueryOptions& options, WordsByKey& given) {
    CLI::App* command =
        app.add_subcommand("query", "Write what one structure answers at given places");
    command
        ->add_option("INPUT", options.input,
                     "Study file (.toml), file of sources, or control space (.ctrl)")
        ->required()
        ->option_text("FILE");
    command->add_option("POINTS", options.points, "Places: columns x, y and z, others passed over")
        ->required()
        ->option_text("FILE.csv");
    command
        ->add_option("-o,--output", options.output,
                     "File to write: x,y,z,h, or the components of M; left out: standard output")
        ->option_text("FILE.csv");
    add_making_options(*command, given);
    command->add_flag("--quiet", options.quiet, "No progress on standard error");
    return command;
}

}  // namespace controlspace
