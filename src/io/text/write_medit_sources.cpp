#include "io/text/write_medit_sources.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "controlspace/sources/riemannian.h"
#include "io/text/output_file.h"

namespace controlspace {
namespace {

/// A field of a file: as many numbers a row, and a reference behind them or not.
struct Rows {
    const char* keyword;
    std::int32_t code;
    std::vector<std::int32_t> head;  ///< between the count and the rows
    std::size_t count;
    std::size_t numbers;  ///< in a row
    bool references;
    std::vector<double> values;
};

Rows vertices_of(std::span<const PointSource> sources) {
    Rows rows{"Vertices", 4, {}, sources.size(), 3, true, {}};
    for (const PointSource& s : sources) {
        rows.values.insert(rows.values.end(), s.position.begin(), s.position.end());
    }
    return rows;
}

constexpr std::int32_t fields = 1, scalar = 1, symmetric_tensor = 3, solution_code = 62;

Rows sizes_of(std::span<const PointSource> sources) {
    Rows rows{"SolAtVertices", solution_code, {fields, scalar}, sources.size(), 1, false, {}};
    for (const PointSource& s : sources) rows.values.push_back(s.metric.xx);
    return rows;
}

Rows tensors_of(std::span<const Metric> metrics) {
    Rows rows{
        "SolAtVertices", solution_code, {fields, symmetric_tensor}, metrics.size(), 6, false, {}};
    for (const Metric& m : metrics) {
        const Metric t = to_riemannian(m);
        rows.values.insert(rows.values.end(), {t.xx, t.xy, t.yy, t.xz, t.yz, t.zz});
    }
    return rows;
}

void append_text(fmt::memory_buffer& text, const Rows& rows) {
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "MeshVersionFormatted 2\n\nDimension 3\n\n{}\n{}\n", rows.keyword,
                   rows.count);
    for (const std::int32_t number : rows.head) fmt::format_to(out, "{} ", number);
    if (!rows.head.empty()) fmt::format_to(out, "\n");
    const double* value = rows.values.data();
    for (std::size_t i = 0; i < rows.count; ++i) {
        for (std::size_t k = 0; k < rows.numbers; ++k) fmt::format_to(out, "{} ", *value++);
        fmt::format_to(out, "{}", rows.references ? "0\n" : "\n");
    }
    fmt::format_to(out, "\nEnd\n");
}

class Bytes {
public:
    explicit Bytes(fmt::memory_buffer& buffer) : buffer_(buffer) {}

    template <class Number>
    void append(Number number) {
        const char* raw = reinterpret_cast<const char*>(&number);
        buffer_.append(raw, raw + sizeof number);
    }
    /// Where the next block begins, as a number of as many bytes as `wide` says.
    void append_place(std::size_t place, bool wide) {
        if (wide) {
            append(static_cast<std::int64_t>(place));
        } else {
            append(static_cast<std::int32_t>(place));
        }
    }
    std::size_t size() const { return buffer_.size(); }

private:
    fmt::memory_buffer& buffer_;
};

void append_binary(fmt::memory_buffer& buffer, const Rows& rows) {
    constexpr std::int32_t cookie = 1, dimension_code = 3, dimension = 3, end_code = 54;
    constexpr std::size_t word = sizeof(std::int32_t);
    const std::size_t data = rows.values.size() * sizeof(double) +
                             (rows.references ? rows.count * word : 0) +
                             (1 + rows.head.size()) * word;
    constexpr std::size_t most_head = 64;
    const bool wide = data + most_head > std::numeric_limits<std::int32_t>::max();
    const std::size_t place = wide ? sizeof(std::int64_t) : word;

    Bytes bytes(buffer);
    bytes.append(cookie);
    bytes.append(std::int32_t{wide ? 3 : 2});
    bytes.append(dimension_code);
    bytes.append_place(bytes.size() + place + word, wide);
    bytes.append(dimension);
    bytes.append(rows.code);
    bytes.append_place(bytes.size() + place + data, wide);
    bytes.append(static_cast<std::int32_t>(rows.count));
    for (const std::int32_t number : rows.head) bytes.append(number);
    const double* value = rows.values.data();
    for (std::size_t i = 0; i < rows.count; ++i) {
        for (std::size_t k = 0; k < rows.numbers; ++k) bytes.append(*value++);
        if (rows.references) bytes.append(std::int32_t{0});
    }
    bytes.append(end_code);
    bytes.append_place(0, wide);
}

void write(OutputFile& file, const std::filesystem::path& path, const Rows& rows) {
    fmt::memory_buffer buffer;
    if (is_binary_medit_name(path)) {
        append_binary(buffer, rows);
    } else {
        append_text(buffer, rows);
    }
    file.write({buffer.data(), buffer.size()});
}

}  // namespace

bool is_binary_medit_name(const std::filesystem::path& path) {
    const std::string name = path.string();
    return name.ends_with('b') || name.ends_with('B');
}

void write_medit_solution(const std::filesystem::path& path, std::span<const Metric> metrics) {
    OutputFile file(path);
    write(file, path, tensors_of(metrics));
    file.commit();
}

void write_medit_sources(const std::filesystem::path& path, std::span<const PointSource> sources) {
    const bool isotropic = std::all_of(sources.begin(), sources.end(),
                                       [](const PointSource& s) { return is_isotropic(s.metric); });
    std::vector<Metric> metrics;
    if (!isotropic) {
        for (const PointSource& s : sources) metrics.push_back(s.metric);
    }
    const bool binary = is_binary_medit_name(path);
    std::filesystem::path mesh = path, solution = path;
    mesh.replace_extension(binary ? ".meshb" : ".mesh");
    solution.replace_extension(binary ? ".solb" : ".sol");
    OutputFile mesh_file(mesh), solution_file(solution);
    write(mesh_file, mesh, vertices_of(sources));
    write(solution_file, solution, isotropic ? sizes_of(sources) : tensors_of(metrics));
    mesh_file.commit();
    solution_file.commit();
}

}  // namespace controlspace
