#include "sources/medit.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "error.h"
#include "sources/medit_words.h"
#include "sources/text_file.h"

namespace controlspace {

namespace {

enum SolutionType : std::uint64_t { scalar = 1, symmetric_tensor = 3 };

// 𝓜^-1/2, or nothing where it is not positive definite.
std::optional<Metric> from_riemannian(const Metric& riemannian) {
    if (!is_positive_definite(riemannian)) return std::nullopt;
    EigenFrame frame = eigen_frame(riemannian);
    for (double& length : frame.lengths) length = 1 / std::sqrt(length);
    const Metric m = metric_from_frame(frame.lengths, frame.directions);
    if (!is_source_metric(m)) return std::nullopt;
    return m;
}

}  // namespace

std::vector<Point> parse_medit_vertices(std::string_view text, const std::filesystem::path& path) {
    MeditWords words(text, path);
    words.find("Vertices");
    std::vector<Point> vertices(words.rows("Vertices", 4));
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        for (Axis a = 0; a < 3; ++a) {
            vertices[i][a] = words.number("vertex", i);
            if (!is_coordinate(vertices[i][a])) {
                words.fail(fmt::format("vertex {}: {} is too large", i + 1, vertices[i][a]));
            }
        }
        words.number("vertex", i);  // the reference says nothing about sizes
    }
    return vertices;
}

std::vector<Metric> parse_medit_metrics(std::string_view text, const std::filesystem::path& path) {
    MeditWords words(text, path);
    words.find("SolAtVertices");
    const std::size_t n = words.rows("SolAtVertices", 1);
    const std::uint64_t fields = words.count("SolAtVertices");
    if (fields != 1) words.fail(fmt::format("{} fields: give a file with one", fields));
    const std::uint64_t type = words.count("the number of fields");
    std::vector<Metric> metrics;
    if (type == scalar) {
        for (std::size_t i = 0; i < n; ++i) {
            const double h = words.number("size", i);
            if (!is_length(h)) {
                words.fail(fmt::format("size {} is {}: a length must be positive", i + 1, h));
            }
            metrics.push_back(Metric::isotropic(h));
        }
        return metrics;
    }
    if (type != symmetric_tensor) {
        words.fail(fmt::format(
            "field of type {}: give scalars (1), which are sizes, or symmetric tensors (3)", type));
    }
    std::size_t wrong = 0;
    std::size_t first_wrong = 0;
    for (std::size_t i = 0; i < n; ++i) {
        Metric t;
        for (double* entry : {&t.xx, &t.xy, &t.yy, &t.xz, &t.yz, &t.zz}) {
            *entry = words.number("tensor", i);
        }
        const std::optional<Metric> m = from_riemannian(t);
        if (m) {
            metrics.push_back(*m);
        } else if (wrong++ == 0) {
            first_wrong = i + 1;
        }
    }
    if (wrong > 0) {
        throw InputError(fmt::format(
            "tensor {} of {} is not positive definite, {} of {} are not: is the order of their "
            "components xx xy yy xz yz zz?",
            first_wrong, path.string(), wrong, n));
    }
    return metrics;
}

std::vector<PointSource> read_medit_sources(const std::filesystem::path& mesh,
                                            const std::filesystem::path& solution) {
    const std::vector<Point> vertices = parse_medit_vertices(read_text_file(mesh), mesh);
    const std::vector<Metric> metrics = parse_medit_metrics(read_text_file(solution), solution);
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
