// SPDX-License-Identifier: Apache-2.0
#include "io/text/medit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "files/text_file.h"
#include "io/text/medit_file.h"
#include "io/text/metric_rows.h"
#include "refuse.h"

namespace controlspace {
namespace {

constexpr std::int32_t one_field = 1, scalar = 1, symmetric_tensor = 3;

/// Of sizes, or of tensors.
void write_solution(MeditWriter& file, std::span<const Metric> metrics, bool sizes) {
    const std::size_t components = sizes ? 1 : medit_tensor.numbers;
    file.begin(medit_solution, metrics.size(), components * sizeof(double),
               {one_field, sizes ? scalar : symmetric_tensor});
    for (const Metric& m : metrics) {
        const auto numbers = sizes ? std::array<double, 9>{m.xx} : numbers_of(m, medit_tensor);
        file.row<double>(std::span(numbers).first(components), std::nullopt);
    }
    file.finish();
}

/// A Riemannian metric of the plane, xx xy yy, with the longer of its lengths across the plane.
std::vector<double> in_space(const std::vector<double>& m) {
    const double mean = (m[0] + m[2]) / 2;
    return {m[0], m[1], m[2], 0, 0, mean - std::hypot((m[0] - m[2]) / 2, m[1])};
}

}  // namespace

std::vector<Point> parse_medit_vertices(std::string_view bytes, const std::filesystem::path& path) {
    MeditReader file(bytes, path);
    std::vector<Point> vertices(file.find(medit_vertices, 2, 1), Point::Zero());
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        for (std::size_t a = 0; a < file.dimension(); ++a) {
            vertices[i][static_cast<Axis>(a)] = file.number({"vertex", i});
        }
        require_coordinates(vertices[i], "vertex", i + 1, [&] { return file.where(); });
        file.skip_reference({"vertex", i});
    }
    file.end_rows();
    return vertices;
}

std::vector<Metric> parse_medit_metrics(std::string_view bytes, const std::filesystem::path& path) {
    MeditReader file(bytes, path);
    const std::size_t rows = file.find(medit_solution, 1, 0);
    const std::int64_t fields = file.integer("SolAtVertices");
    if (fields != one_field) file.fail("{} fields: give a file with one", fields);
    const std::int64_t type = file.integer("the number of fields");
    if (type != scalar && type != symmetric_tensor) {
        file.fail("field of type {}: give scalars (1), which are sizes, or symmetric tensors (3)",
                  type);
    }
    const char* const what = type == scalar ? "size" : "tensor";
    const bool is_plane = type == symmetric_tensor && file.dimension() == 2;
    std::vector<double> numbers(type == scalar ? 1 : is_plane ? 3 : medit_tensor.numbers);
    MetricRows metrics([&] { return file.where(); }, medit_tensor);
    for (std::size_t i = 0; i < rows; ++i) {
        for (double& x : numbers) x = file.number({what, i});
        metrics.add(is_plane ? in_space(numbers) : numbers);
    }
    file.end_rows();
    return metrics.take();
}

std::vector<Point> read_medit_vertices(const std::filesystem::path& mesh) {
    return parse_medit_vertices(read_binary_file(mesh), mesh);
}

std::vector<PointSource> read_medit_sources(const std::filesystem::path& mesh,
                                            const std::filesystem::path& solution) {
    const std::vector<Point> vertices = read_medit_vertices(mesh);
    const std::vector<Metric> metrics = parse_medit_metrics(read_binary_file(solution), solution);
    if (vertices.size() != metrics.size()) {
        refuse(
            "{} has {} vertices, and {} has sizes for {}: give two files "
            "that belong together",
            mesh.string(), vertices.size(), solution.string(), metrics.size());
    }
    return sources_from(vertices, metrics);
}

std::vector<PointSource> read_medit_required_edges(const std::filesystem::path& mesh) {
    return parse_medit_required_edges(read_binary_file(mesh), mesh);
}

std::vector<PointSource> parse_medit_required_edges(std::string_view bytes,
                                                    const std::filesystem::path& mesh) {
    const std::vector<Point> vertices = parse_medit_vertices(bytes, mesh);
    const auto edges = read_medit_elements<2>(bytes, mesh, medit_edges, vertices.size());
    struct Lengths {
        double sum = 0;
        std::size_t count = 0;
    };
    std::vector<Lengths> at(vertices.size());
    MeditReader required(bytes, mesh);
    for (std::size_t i = 0, count = required.find(medit_required_edges, 0, 1); i < count; ++i) {
        const auto most = static_cast<std::int64_t>(edges.size());
        const auto edge =
            static_cast<std::size_t>(required.integer({"required edge", i}, most)) - 1;
        const auto [from, to] = edges[edge];
        const double length = (vertices[to] - vertices[from]).norm();
        if (!is_length(length)) required.fail("edge {} has the length {}", edge + 1, length);
        for (const std::size_t end : {from, to}) {
            at[end].sum += length;
            ++at[end].count;
        }
    }
    required.end_rows();
    std::vector<PointSource> sources;
    for (std::size_t i = 0; i < at.size(); ++i) {
        if (at[i].count == 0) continue;
        const double mean = at[i].sum / static_cast<double>(at[i].count);
        sources.push_back({vertices[i], Metric::isotropic(mean)});
    }
    return sources;
}

void write_medit_solution(const std::filesystem::path& path, std::span<const Metric> metrics,
                          bool keep_tensors) {
    const bool sizes = !keep_tensors && std::ranges::all_of(metrics, is_isotropic);
    MeditWriter file(path, metrics.size() * medit_tensor.numbers * sizeof(double));
    write_solution(file, metrics, sizes);
    file.commit();
}

void write_medit_sources(const std::filesystem::path& path, std::span<const PointSource> sources) {
    const bool binary = is_binary_medit_name(path), sizes = all_isotropic(sources);
    std::filesystem::path mesh = path, solution = path;
    mesh.replace_extension(binary ? ".meshb" : ".mesh");
    solution.replace_extension(binary ? ".solb" : ".sol");
    MeditWriter mesh_file(mesh, sources.size() * medit_vertex_bytes);
    MeditWriter solution_file(solution,
                              sources.size() * sizeof(double) * (sizes ? 1 : medit_tensor.numbers));
    std::vector<Metric> metrics;
    mesh_file.begin(medit_vertices, sources.size(), medit_vertex_bytes);
    for (const PointSource& s : sources) {
        mesh_file.row<double>({s.position.data(), 3}, 0);
        metrics.push_back(s.metric);
    }
    mesh_file.finish();
    write_solution(solution_file, metrics, sizes);
    mesh_file.commit();
    solution_file.commit();
}

}  // namespace controlspace
