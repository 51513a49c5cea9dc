#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <csignal>
#include <exception>
#include <new>
#include <string>

#include "cli/build.h"
#include "cli/command_line.h"
#include "cli/compare.h"
#include "cli/export.h"
#include "cli/list.h"
#include "cli/mesh.h"
#include "cli/standard_output.h"
#include "controlspace/error.h"

namespace {

int fail(int status, std::string what) {
    std::replace(what.begin(), what.end(), '\n', ' ');
    controlspace::print_error(fmt::format("controlspace: error: {}\n", what));
    return status;
}

}  // namespace

int main(int argc, char** argv) {
    using namespace controlspace;
    keep_standard_places();
    std::signal(SIGXFSZ, SIG_IGN);  // beyond a limit, writing fails as on a full disk
    try {
        spdlog::set_default_logger(spdlog::stderr_color_mt("controlspace"));
        spdlog::set_pattern("%n: %l: %v");
        const Command command = parse_command_line(argc, argv);
        if (const auto* text = std::get_if<TextCommand>(&command)) {
            print(text->text);
        } else if (std::holds_alternative<ListCommand>(command)) {
            print(list_text());
        } else if (const auto* info_options = std::get_if<InfoOptions>(&command)) {
            info(*info_options);
        } else if (const auto* convert_options = std::get_if<ConvertOptions>(&command)) {
            convert(*convert_options);
        } else if (const auto* build_options = std::get_if<BuildOptions>(&command)) {
            build(*build_options);
        } else if (const auto* query_options = std::get_if<QueryOptions>(&command)) {
            query(*query_options);
        } else if (const auto* export_options = std::get_if<ExportOptions>(&command)) {
            export_field(*export_options);
#ifdef CONTROLSPACE_GMSH
        } else if (const auto* mesh_options = std::get_if<MeshOptions>(&command)) {
            return mesh(*mesh_options) ? 0 : 3;
#endif
        } else {
            return compare(std::get<CompareOptions>(command)) ? 0 : 3;
        }
        return 0;
    } catch (const InputError& error) {
        return fail(2, error.what());
    } catch (const std::bad_alloc&) {
        return fail(1, "out of memory: give fewer sources, or lower --max-memory");
    } catch (const std::exception& error) {
        return fail(1, fmt::format("unexpected: {}", error.what()));
    }
}
