#include "mesh/write_medit.h"

#include <fmt/format.h>

#include <iterator>
#include <string>

#include "sources/output_file.h"

namespace controlspace {
namespace {

constexpr const char* head = "MeshVersionFormatted 2\n\nDimension 3\n";

void write(const std::filesystem::path& path, const fmt::memory_buffer& text) {
    OutputFile file(path);
    file.write({text.data(), text.size()});
    file.commit();
}

template <class Elements>
void append(fmt::memory_buffer& text, const char* keyword, const Elements& elements) {
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "\n{}\n{}\n", keyword, elements.size());
    for (const auto& element : elements) {
        for (const VertexIndex i : element) fmt::format_to(out, "{} ", i + 1);
        fmt::format_to(out, "1\n");
    }
}

Metric riemannian(const Metric& m) {
    EigenFrame frame = eigen_frame(m);
    for (double& h : frame.lengths) h = 1 / (h * h);
    return metric_from_frame(frame.lengths, frame.directions);
}

}  // namespace

void write_medit_mesh(const std::filesystem::path& path, const TetMesh& mesh) {
    fmt::memory_buffer text;
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "{}\nVertices\n{}\n", head, mesh.vertices.size());
    for (const Point& p : mesh.vertices) {
        fmt::format_to(out, "{} {} {} 0\n", p.x(), p.y(), p.z());
    }
    append(text, "Triangles", mesh.triangles);
    append(text, "Tetrahedra", mesh.tets);
    fmt::format_to(out, "\nEnd\n");
    write(path, text);
}

void write_medit_solution(const std::filesystem::path& path, std::span<const Metric> metrics) {
    constexpr int fields = 1, symmetric_tensor = 3;
    fmt::memory_buffer text;
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "{}\nSolAtVertices\n{}\n{} {}\n", head, metrics.size(), fields,
                   symmetric_tensor);
    for (const Metric& m : metrics) {
        const Metric t = riemannian(m);
        fmt::format_to(out, "{} {} {} {} {} {}\n", t.xx, t.xy, t.yy, t.xz, t.yz, t.zz);
    }
    fmt::format_to(out, "\nEnd\n");
    write(path, text);
}

}  // namespace controlspace
