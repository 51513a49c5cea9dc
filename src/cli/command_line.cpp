#include "cli/command_line.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <vector>

#include "cli/export_command.h"
#include "cli/file_commands.h"
#include "cli/setting_options.h"
#include "controlspace/error.h"
#include "mesh/mesh_settings.h"
#include "study/provenance.h"
#include "study/settings.h"

namespace controlspace {
namespace {

#ifdef CONTROLSPACE_GMSH
CLI::App* add_mesh(CLI::App& app, MeshOptions& options, WordsByKey& given) {
    CLI::App* command = app.add_subcommand(
        "mesh", "Make meshes with structures as size fields, and measure how they conform");
    add_filled_input(*command, options.input);
    add_options(*command, mesh_settings(), MeshSettings{}, "Settings of the meshing", given);
    constexpr std::string_view without[] = {"access_points", "access_repeats", "fine_probe_grid"};
    Run defaults;
    defaults.structures = {"K_oL"};
    defaults.splits = {SplitRule::middle};
    add_options(*command, run_settings(), defaults,
                "Settings of cases (lists with commas; all combinations are meshed)", given);
    add_options(*command, study_settings(), Study{}, "Settings of the study", given, without);
    command->add_flag("--quiet", options.quiet, "No progress on standard error");
    return command;
}
#endif

/// CLI11 would say of another word only that a command is missing.
void require_command(CLI::App& app, const std::string& word) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
    if (std::find(names.begin(), names.end(), word) != names.end()) return;
    throw InputError(
        fmt::format("unknown command '{}': give one of {}", word, fmt::join(names, ", ")));
}

/// The command line as a shell would take it again.
std::string command_line_text(int argc, const char* const* argv) {
    std::string text;
    for (int i = 0; i < argc; ++i) {
        std::string word = argv[i];
        if (word.empty() || word.find_first_of(" \t\n'\"\\$`*?&|;<>()[]{}#~!") != word.npos) {
            std::string quoted;
            for (const char c : word)
                quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
            word = "'" + quoted + "'";
        }
        text += (i > 0 ? " " : "") + word;
    }
    return text;
}

}  // namespace

Command parse_command_line(int argc, const char* const* argv) {
    CLI::App app(
        "Compares control spaces for mesh generation: metrics in a box, learnt from points.",
        "controlspace");
    app.set_version_flag("--version", "controlspace " + version_text(current_provenance()));
    app.require_subcommand(1);
    const std::string statuses =
        "Exit status:\n"
        "  0    all went well\n"
        "  1    the program or the system failed\n"
        "  2    what was given cannot be used\n"
        "  3    some cases failed: results are written, and their rows say why\n"
        "  130  stopped by Ctrl-C";
    app.footer(statuses);

    CompareOptions options;
    WordsByKey given;
    CLI::App* compare = app.add_subcommand(
        "compare", "Run a study: make, grade and measure structures on the same sources");
    compare
        ->add_option("STUDY", options.study_file,
                     "Study file (.toml); left out: the paper's sphere at rho = tau = 1, in both "
                     "modes, or one run if sources, field, law, schedule or reference are given")
        ->option_text("FILE.toml");
    add_options(*compare, run_settings(), Run{},
                "Settings of cases (lists with commas; all combinations are run)", given);
    auto* published = compare->add_flag(
        "--as-published", options.as_published,
        "As for the paper's tables: --law mean-length --schedule passes --reference "
        "published-sphere");
    published->option_text(" ")->group(
        "Settings of cases (lists with commas; all combinations are run)");
    for (const char* name : {"--law", "--schedule", "--reference"}) {
        published->excludes(compare->get_option(name));
    }
    add_options(*compare, study_settings(), Study{}, "Settings of the study", given);
    compare->add_flag("--dry-run", options.dry_run,
                      "Only list the cases, with estimates of time and memory from small trials");
    compare
        ->add_option("--resume", options.resume,
                     "Go on with an interrupted run, whose results lie in FOLDER: the study and "
                     "settings must be the same, but for --output")
        ->option_text("FOLDER")
        ->excludes(compare->get_option("--output"));
    compare->add_flag("--quiet", options.quiet, "No progress on standard error");
    compare->footer(statuses);

    ExportOptions export_options;
    WordsByKey given_to_export;
    const CLI::App* export_command = add_export(app, export_options, given_to_export);

#ifdef CONTROLSPACE_GMSH
    MeshOptions mesh_options;
    WordsByKey given_to_mesh;
    const CLI::App* mesh_command = add_mesh(app, mesh_options, given_to_mesh);
#endif

    InfoOptions info_options;
    WordsByKey given_to_info;
    const CLI::App* info_command = add_info(app, info_options, given_to_info);
    ConvertOptions convert_options;
    WordsByKey given_to_convert;
    const CLI::App* convert_command = add_convert(app, convert_options, given_to_convert);
    BuildOptions build_options;
    WordsByKey given_to_build;
    const CLI::App* build_command = add_build(app, build_options, given_to_build);
    QueryOptions query_options;
    WordsByKey given_to_query;
    const CLI::App* query_command = add_query(app, query_options, given_to_query);

    CLI::App* list =
        app.add_subcommand("list", "Name the structures, splits, laws, schedules and references");

    if (argc > 1 && argv[1][0] != '-') require_command(app, argv[1]);
    try {
        app.parse(argc, argv);
    } catch (const CLI::CallForHelp&) {
        return TextCommand{app.help()};
    } catch (const CLI::CallForVersion& version) {
        return TextCommand{std::string(version.what()) + "\n"};
    } catch (const CLI::ParseError& error) {
        throw InputError(fmt::format("{} (see controlspace --help)", error.what()));
    }
    if (list->parsed()) return ListCommand{};
    const auto with_settings = [](auto& command_options, const WordsByKey& words) {
        command_options.settings = given_settings(words);
        return command_options;
    };
    if (info_command->parsed()) return with_settings(info_options, given_to_info);
    if (convert_command->parsed()) return with_settings(convert_options, given_to_convert);
    if (build_command->parsed()) return with_settings(build_options, given_to_build);
    if (query_command->parsed()) return with_settings(query_options, given_to_query);
    if (export_command->parsed()) {
        export_options.settings = given_settings(given_to_export);
        export_options.command_line = command_line_text(argc, argv);
        return export_options;
    }
#ifdef CONTROLSPACE_GMSH
    if (mesh_command->parsed()) {
        mesh_options.settings = given_settings(given_to_mesh);
        mesh_options.command_line = command_line_text(argc, argv);
        return mesh_options;
    }
#endif
    options.settings = given_settings(given);
    options.command_line = command_line_text(argc, argv);
    return options;
}

}  // namespace controlspace
