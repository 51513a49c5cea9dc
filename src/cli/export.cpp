#include "cli/export.h"

#include <fmt/format.h>

#include <map>
#include <memory>

#include "cli/export_vdb.h"
#include "cli/filled_space.h"
#include "cli/standard_output.h"
#include "cli/step_progress.h"
#include "controlspace/error.h"
#include "controlspace/io/read_sources.h"
#include "controlspace/space/space_field.h"
#include "io/text/medit.h"
#include "io/text/write_medit_sources.h"
#include "io/text/write_sources.h"

namespace controlspace {
namespace {

/// What a format is made of, and how: `write` says what was written beside the file's size.
struct Exported {
    const ExportOptions& options;
    const FilledSpace& filled;
    StepProgress& progress;
    const ControlSpace& space = *filled.space;
};
using Write = std::string (*)(const Exported&);

std::string size_note(const Exported& e, const std::string& what) {
    std::error_code none;  // a pipe has no size
    const std::uintmax_t bytes = std::filesystem::file_size(e.options.output, none);
    const std::string size =
        none ? "" : fmt::format("; {:.1f} MB", static_cast<double>(bytes) / 1e6);
    return fmt::format("{}: {}{}\n", e.options.output.string(), what, size);
}

std::string write_solution(const Exported& e) {
    const std::vector<Point> vertices = read_medit_vertices(e.options.mesh);
    std::vector<Metric> metrics(vertices.size());
    e.space.sample(vertices, metrics);
    write_medit_solution(e.options.output, metrics);
    return size_note(e, fmt::format("metrics at the {} vertices of {}", vertices.size(),
                                    e.options.mesh.string()));
}

std::string write_node_table(const Exported& e) {
    const ControlNodes nodes = e.space.control_nodes(Neighbourhood::faces);
    const std::vector<Point> places = positions(nodes.graph);
    std::vector<PointSource> sources;
    for (std::size_t i = 0; i < places.size(); ++i)
        sources.push_back({places[i], nodes.metrics[i]});
    write_sources(e.options.output, sources);
    return size_note(e, fmt::format("{} control nodes", sources.size()));
}

#ifdef CONTROLSPACE_VTK
std::string write_grid(const Exported& e) {
    if (e.options.nodes) {
        write_nodes(e.options.output, e.space);
        return size_note(e, fmt::format("{} control nodes", e.space.footprint().control_nodes));
    }
    write_leaves(e.options.output, e.space);
    return size_note(e, "the elements, with their metrics");
}

std::string write_tree(const Exported& e) {
    write_octree(e.options.output, e.space);
    return size_note(e, "an octree");
}

Slice slice_of(const ExportOptions& options, const Box& domain) {
    const std::string& name = options.slice.front();
    const std::size_t axis = std::string("xyz").find(name);
    if (name.size() != 1 || axis > 2) {
        throw InputError(fmt::format("--slice: {} is no axis: give x, y or z", quote(name)));
    }
    Slice slice;
    slice.axis = static_cast<Axis>(axis);
    slice.at = domain.centre()[slice.axis];
    slice.samples = options.samples;
    if (options.slice.size() > 1 && !parse_number(options.slice[1], slice.at)) {
        throw InputError(fmt::format("--slice: {} is not a number", quote(options.slice[1])));
    }
    return slice;
}

std::string write_image(const Exported& e) {
    const Slice slice = slice_of(e.options, e.space.domain());
    write_slice(e.options.output, SpaceAsField(e.space), e.space.domain(), slice);
    return size_note(e, fmt::format("a slice at {} = {}", "xyz"[slice.axis], slice.at));
}
#endif

#ifdef CONTROLSPACE_OPENVDB
std::string write_grids(const Exported& e) { return export_vdb(e.options, e.filled, e.progress); }
#endif

const std::map<std::string, Write>& formats() {
    static const std::map<std::string, Write> all{
        {".csv", write_node_table}, {".pos", write_node_table}, {".sol", write_solution},
        {".solb", write_solution},
#ifdef CONTROLSPACE_OPENVDB
        {".vdb", write_grids},
#endif
#ifdef CONTROLSPACE_VTK
        {".htg", write_tree},       {".vti", write_image},      {".vtu", write_grid},
#endif
    };
    return all;
}

Write format_of(const ExportOptions& options) {
    const std::string ending = lower_case_extension(options.output);
    const auto format = formats().find(ending);
    if (format == formats().end()) {
        throw InputError(fmt::format("{}: name a file of one of {}", options.output.string(),
                                     exported_formats()));
    }
    if (format->second == write_solution && options.mesh.empty()) {
        throw InputError(
            fmt::format("{}: name the mesh that it is for by --mesh", options.output.string()));
    }
    return format->second;
}

}  // namespace

std::string exported_formats() {
    std::string endings;
    for (const auto& [ending, write] : formats()) {
        endings += (endings.empty() ? "" : ", ") + ending;
    }
    return endings;
}

void export_field(const ExportOptions& options) {
    const Write write = format_of(options);
    std::string said;
    {
        StepProgress progress(options.quiet, options.output);
        const FilledSpace filled =
            filled_space(options.input, options.settings, progress.observer());
        progress.started("sampling and writing");
        said = write({options, filled, progress});
    }
    print(said);
}

}  // namespace controlspace
