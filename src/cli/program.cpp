// SPDX-License-Identifier: Apache-2.0
#include "cli/program.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include "cli/command.h"
#include "cli/help.h"
#include "cli/mesh_apart.h"
#include "cli/options.h"
#include "cli/standard_output.h"
#include "controlspace/error.h"
#include "controlspace/study/provenance.h"
#include "files/text_file.h"
#include "refuse.h"

namespace controlspace {
namespace {

struct CommandRow {
    const char* name;
    const char* description;
    Action (*add)(Options& options);
    const char* examples;
};
constexpr CommandRow commands[] = {
    {"compare", "Run a study: build, grade and measure structures on the same sources", add_compare,
     "  controlspace compare my_sources.csv\n"
     "  controlspace compare mesh.sol --target-delta 0.1 --structures K_oLA,K_oV\n"
     "  controlspace compare study.toml --dry-run\n"},
    {"info", "Describe sources (number, sizes, gradation) or a control space", add_info,
     "  controlspace info part.stl\n"
     "  controlspace info field.ctrl\n"},
    {"convert", "Write the sources of one file in another format", add_convert,
     "  controlspace convert mesh.sol sources.csv\n"
     "  controlspace convert part.stl -o sources.vtu --isotropic\n"},
    {"build", "Build and grade one structure, and save it", add_build,
     "  controlspace build my_sources.csv -o field.ctrl\n"
     "  controlspace build mesh.sol -o field.ctrl --within 1.2\n"},
    {"query", "Write the metrics of one structure at given points", add_query,
     "  controlspace query field.ctrl places.csv -o metrics.csv\n"
     "  controlspace query field.ctrl --pipe    # for Gmsh's field ExternalProcess\n"},
    {"export",
     "Write the field of one structure to a file, for Blender, Houdini, ParaView or a mesher",
     add_export,
     "  controlspace export field.ctrl -o field.vtu\n"
     "  controlspace export field.ctrl -o field.sol --mesh mesh.mesh\n"
     "  controlspace export part.stl -o part.b.mtr    # for TetGen's part.poly\n"
     "  controlspace export sphere --h 0.05 -o sphere.structured\n"},
    {"mesh", "Make meshes with structures as size fields, and measure their conformity", add_mesh,
     "  controlspace mesh part.step --isotropic\n"
     "  controlspace mesh field.ctrl --part part.stl --mesher hxt\n"},
    {"list", "List the structures and other values of options", add_list, ""},
};

constexpr const char* statuses =
    "Exit status:\n"
    "  0    success\n"
    "  1    the program or the system failed\n"
    "  2    the input cannot be used\n"
    "  3    some cases failed, or missed the requested target: results are written, and say why\n"
    "  130  interrupted by Ctrl-C";

/// For another word, CLI11 reports only that a command is missing.
void require_command(const std::string& word) {
    std::vector<std::string> names;
    for (const CommandRow& row : commands) names.emplace_back(row.name);
    if (std::ranges::count(names, word) > 0) return;
    names.emplace_back("help");
    const std::string nearest = did_you_mean(word, names);
    refuse("unknown command '{}'{}", word,
           nearest.empty() ? fmt::format(": give one of {}", fmt::join(names, ", ")) : nearest);
}

/// Throws InputError for the first option that `command` does not have. CLI11 puts other errors
/// first, of what is missing without it.
void require_options(const CLI::App& command) {
    for (std::string word : command.remaining()) {
        if (word.size() < 2 || word[0] != '-') continue;
        word.resize(std::min(word.size(), word.find('=')));
        std::vector<std::string> names;
        for (const CLI::Option* option : command.get_options()) {
            for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
        }
        refuse("unknown option {}{} (see controlspace {}--help)", word, did_you_mean(word, names),
               command.get_parent() == nullptr ? "" : command.get_name() + " ");
    }
}

/// The command line, quoted for a shell.
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

int run(int argc, const char* const* argv) {
    if (argc == 3 && std::string_view(argv[1]) == gmsh_job) return run_gmsh_job(argv[2]);
    CLI::App app(
        "Builds and compares control spaces for mesh generation: metrics at every point of a box, "
        "from point sources.",
        "controlspace");
    app.set_version_flag("--version", "controlspace " + version_text(current_provenance()));
    app.require_subcommand(1);
    app.footer(std::string("Examples:\n"
                           "  controlspace build part.stl -o part.ctrl\n"
                           "  controlspace help COMMAND\n\n") +
               statuses);
    set_help(app);
    std::deque<Options> options;
    std::vector<Action> actions;
    for (const CommandRow& row : commands) {
        CLI::App* command = app.add_subcommand(row.name, row.description);
        actions.push_back(row.add(options.emplace_back(*command)));
        options.back().set_footer(row.examples, statuses);
    }

    std::vector<std::string> words(argv + 1, argv + argc);
    if (!words.empty() && words.front() == "help") {
        std::erase(words, "help");
        words.emplace_back("--help");
    }
    if (!words.empty() && !words.front().starts_with('-')) require_command(words.front());
    std::ranges::reverse(words);  // as CLI11 takes them
    try {
        app.parse(words);
    } catch (const CLI::CallForHelp&) {
        print(app.help());
        return 0;
    } catch (const CLI::CallForVersion& version) {
        print(std::string(version.what()) + "\n");
        return 0;
    } catch (const CLI::ParseError& error) {
        const auto given = app.get_subcommands();
        require_options(given.empty() ? app : *given.front());
        refuse("{} (see controlspace {}--help)", error.what(),
               given.empty() ? "" : given.front()->get_name() + " ");
    }
    for (std::size_t i = 0; i < actions.size(); ++i) {
        if (app.got_subcommand(commands[i].name)) return actions[i](command_line_text(argc, argv));
    }
    return 0;
}

int fail(int status, std::string what) {
    std::replace(what.begin(), what.end(), '\n', ' ');
    print_error(fmt::format("controlspace: error: {}\n", what));
    return status;
}

/// Allocates nothing.
int fail_without_memory() {
    print_error("controlspace: error: out of memory: give fewer sources, or lower --max-memory\n");
    return 1;
}

std::terminate_handler terminate_by_default;

/// Where not even an exception can be allocated, the standard library terminates without one.
void terminate_with_a_word() {
    if (std::current_exception() == nullptr) std::_Exit(fail_without_memory());
    terminate_by_default();
}

/// Before the first constants of libraries are made, which allocate.
[[gnu::constructor(101)]] void set_terminate_first() {
    terminate_by_default = std::set_terminate(terminate_with_a_word);
}

}  // namespace

int run_program(int argc, const char* const* argv) {
    occupy_standard_descriptors();
    std::signal(SIGXFSZ, SIG_IGN);  // beyond a limit, writing fails as on a full disk
    try {
        spdlog::set_default_logger(spdlog::stderr_color_mt("controlspace"));
        spdlog::set_pattern("%n: %l: %v");
        return run(argc, argv);
    } catch (const InputError& error) {
        return fail(2, error.what());
    } catch (const std::bad_alloc&) {
        return fail_without_memory();
    } catch (const std::exception& error) {
        // TBB has no error of its own for it.
        if (std::string_view(error.what()).ends_with(std::strerror(EAGAIN))) {
            return fail(
                1,
                "too little memory to start a thread: raise the limit of memory (ulimit -v) "
                "or of processes (ulimit -u)");
        }
        return fail(1, fmt::format("unexpected: {}", error.what()));
    }
}

}  // namespace controlspace
