#include "io/text/medit.h"

#include <fmt/format.h>

#include <cstdint>
#include <string>

#include "controlspace/error.h"
#include "io/text/metric_rows.h"

namespace controlspace {

namespace {

enum SolutionType : std::uint64_t { scalar = 1, symmetric_tensor = 3 };

template <class Reader>
std::vector<Point> vertices_in(Reader& file) {
    file.find("Vertices");
    std::vector<Point> vertices(file.rows("Vertices", 3, 1));
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        for (Axis a = 0; a < 3; ++a) {
            vertices[i][a] = file.number("vertex", i);
            if (!is_coordinate(vertices[i][a])) {
                file.fail(fmt::format("vertex {}: {} is too large", i + 1, vertices[i][a]));
            }
        }
        file.skip_reference("vertex", i);
    }
    return vertices;
}

template <class Reader>
std::vector<Metric> metrics_in(Reader& file, const std::filesystem::path& path) {
    file.find("SolAtVertices");
    const std::size_t n = file.rows("SolAtVertices", 1, 0);
    const std::uint64_t fields = file.count("SolAtVertices");
    if (fields != 1) file.fail(fmt::format("{} fields: give a file with one", fields));
    const std::uint64_t type = file.count("the number of fields");
    MetricRows metrics(path, "xx xy yy xz yz zz");
    if (type == scalar) {
        for (std::size_t i = 0; i < n; ++i) {
            const double h = file.number("size", i);
            if (!is_length(h)) {
                file.fail(fmt::format("size {} is {}: {}", i + 1, h, length_rule));
            }
            metrics.add_size(h);
        }
        return metrics.take();
    }
    if (type != symmetric_tensor) {
        file.fail(fmt::format(
            "field of type {}: give scalars (1), which are sizes, or symmetric tensors (3)", type));
    }
    for (std::size_t i = 0; i < n; ++i) {
        Metric t;
        for (double* entry : {&t.xx, &t.xy, &t.yy, &t.xz, &t.yz, &t.zz}) {
            *entry = file.number("tensor", i);
        }
        metrics.add_tensor(t);
    }
    return metrics.take();
}

}  // namespace

std::vector<Point> parse_medit_vertices(std::string_view bytes, const std::filesystem::path& path) {
    return read_medit(bytes, path, [](auto& file) { return vertices_in(file); });
}

std::vector<Metric> parse_medit_metrics(std::string_view bytes, const std::filesystem::path& path) {
    return read_medit(bytes, path, [&](auto& file) { return metrics_in(file, path); });
}

std::vector<Point> read_medit_vertices(const std::filesystem::path& mesh) {
    return parse_medit_vertices(read_binary_file(mesh), mesh);
}

std::vector<PointSource> read_medit_sources(const std::filesystem::path& mesh,
                                            const std::filesystem::path& solution) {
    const std::vector<Point> vertices = read_medit_vertices(mesh);
    const std::vector<Metric> metrics = parse_medit_metrics(read_binary_file(solution), solution);
    if (vertices.size() != metrics.size()) {
        throw InputError(
            fmt::format("{} has {} vertices, and {} has sizes for {}: give two files "
                        "that belong together",
                        mesh.string(), vertices.size(), solution.string(), metrics.size()));
    }
    std::vector<PointSource> sources(vertices.size());
    for (std::size_t i = 0; i < sources.size(); ++i) sources[i] = {vertices[i], metrics[i]};
    return sources;
}

}  // namespace controlspace
