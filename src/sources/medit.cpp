#include "sources/medit.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "error.h"
#include "sources/text_file.h"

namespace controlspace {

namespace {

// Medit files are words between white space, whatever the lines; # starts a comment.
class Words {
public:
    Words(std::string_view text, const std::filesystem::path& path) : text_(text), path_(path) {
        if (word() != "MeshVersionFormatted") {
            fail("does not start with MeshVersionFormatted: give an ASCII Medit file");
        }
        const auto version = count("MeshVersionFormatted");
        if (version < 1 || version > 4) fail("MeshVersionFormatted must be 1 to 4");
    }

    /// The next word; empty at the end.
    std::string_view word() {
        while (at_ < text_.size()) {
            const char c = text_[at_];
            if (c == '#') {
                at_ = std::min(text_.find('\n', at_), text_.size());
            } else if (is_blank(c)) {
                line_ += c == '\n' ? 1 : 0;
                ++at_;
            } else {
                break;
            }
        }
        const std::size_t begin = at_;
        while (at_ < text_.size() && !is_blank(text_[at_])) ++at_;
        return text_.substr(begin, at_ - begin);
    }

    /// Goes behind the keyword, checking the dimension on the way.
    void find(std::string_view keyword) {
        bool is_3d = false;
        for (std::string_view w = word(); w != "End"; w = word()) {
            if (w.empty()) break;
            if (w == "Dimension") {
                const auto dimension = count("Dimension");
                if (dimension != 3) {
                    fail(fmt::format("Dimension is {}: only 3 can be read", dimension));
                }
                is_3d = true;
            }
            if (w != keyword) continue;
            if (!is_3d) fail(fmt::format("no Dimension before {}: add 'Dimension 3'", keyword));
            return;
        }
        throw InputError(
            fmt::format("{} has no {}: give a file that has", path_.string(), keyword));
    }

    std::uint64_t count(std::string_view what) {
        const std::string_view w = word();
        std::uint64_t n = 0;
        if (!parse_number(w, n)) {
            fail(fmt::format("{} is followed by {} instead of a count", what, quote(w)));
        }
        return n;
    }

    /// A count of rows with `numbers` numbers each, as the rest of the file can hold.
    std::size_t rows(std::string_view what, std::size_t numbers) {
        const std::uint64_t n = count(what);
        if (n == 0) fail(fmt::format("{} 0: nothing to read", what));
        const std::size_t most = (text_.size() - at_) / (2 * numbers);  // "0 0 0 ..."
        if (n > most) {
            fail(fmt::format("{} {}, but the rest of the file can hold {} at most: is it cut off?",
                             what, n, most));
        }
        return static_cast<std::size_t>(n);
    }

    double number(std::string_view what, std::size_t index) {
        const std::string_view w = word();
        double x = 0;
        if (w.empty()) fail(fmt::format("the file ends within {} {}", what, index + 1));
        if (!parse_number(w, x)) {
            fail(fmt::format("{} {}: {} is not a number", what, index + 1, quote(w)));
        }
        if (!std::isfinite(x)) fail(fmt::format("{} {} has {}, not finite", what, index + 1, x));
        return x;
    }

    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(fmt::format("{}: {}", place(path_, line_), what));
    }

private:
    static bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

    std::string_view text_;
    const std::filesystem::path& path_;
    std::size_t at_ = 0;
    std::size_t line_ = 1;
};

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
    Words words(text, path);
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
    Words words(text, path);
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
