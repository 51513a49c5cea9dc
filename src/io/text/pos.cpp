#include "io/text/pos.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <numeric>

#include "controlspace/error.h"
#include "controlspace/sources/riemannian.h"
#include "geometry/point_order.h"
#include "io/text/metric_rows.h"
#include "io/text/output_file.h"
#include "io/text/text_file.h"

namespace controlspace {
namespace {

constexpr std::size_t tensor_numbers = 9;

/// Corners of an element of that letter; 0 for a letter that is none.
std::size_t corners_of(char letter) {
    constexpr std::string_view letters = "PLTQSHIY";
    constexpr std::array<std::size_t, 8> corners{1, 2, 3, 4, 4, 8, 6, 5};
    const std::size_t i = letters.find(letter);
    return i < corners.size() ? corners[i] : 0;
}

class Parser {
public:
    Parser(std::string_view text, const std::filesystem::path& path, const std::string& view)
        : text_(text), path_(path), view_(view), metrics_(path, "by rows") {}

    std::vector<PointSource> sources() {
        skip_blanks();
        while (at_ < text_.size()) {
            expect("View");
            read_view();
            skip_blanks();
        }
        if (names_.empty()) fail("no View: give a list view of Gmsh");
        if (view_.empty() && names_.size() > 1) {
            throw InputError(
                fmt::format("{} holds {} views, the first two {} and {}: name one "
                            "(--source-array)",
                            path_.string(), names_.size(), quote(names_[0]), quote(names_[1])));
        }
        if (!is_found_) {
            throw InputError(fmt::format("{} holds no view {}: its first one is {}", path_.string(),
                                         quote(view_), quote(names_.front())));
        }
        const std::vector<Metric> metrics = metrics_.take();
        if (metrics.empty()) throw InputError(path_.string() + " holds no sources: add some");
        std::vector<PointSource> sources;
        for (std::size_t i = 0; i < metrics.size(); ++i) {
            sources.push_back({places_[i], metrics[i]});
        }
        return sources;
    }

private:
    void read_view() {
        names_.push_back(name());
        const bool is_chosen = view_.empty() ? names_.size() == 1 : names_.back() == view_;
        is_found_ |= is_chosen;
        expect("{");
        while (!accept("}")) read_element(is_chosen);
        accept(";");
    }

    void read_element(bool is_chosen) {
        skip_blanks();
        const std::string_view word = text_.substr(at_, 2);
        const bool is_scalar = word.starts_with('S');
        const std::size_t corners = word.size() == 2 ? corners_of(word[1]) : 0;
        if ((!is_scalar && !word.starts_with('T')) || corners == 0) {
            fail(fmt::format("{} is no element of scalars or tensors (SP, TP, SS, TS and such)",
                             quote(word)));
        }
        at_ += 2;
        read_numbers("(", ")", places_read_, 3 * corners);
        for (const double x : places_read_) {
            if (!is_coordinate(x)) fail(fmt::format("{} cannot be a coordinate", x));
        }
        const std::size_t numbers = is_scalar ? 1 : tensor_numbers;
        read_numbers("{", "}", values_read_, numbers * corners);
        expect(";");
        if (!is_chosen) return;
        for (std::size_t i = 0; i < corners; ++i) {
            places_.emplace_back(&places_read_[3 * i]);
            const double* value = &values_read_[numbers * i];
            if (is_scalar) {
                if (!is_length(*value)) {
                    fail(fmt::format("size {}: {}", *value, length_rule));
                }
                metrics_.add_size(*value);
            } else {
                std::array<double, tensor_numbers> tensor;
                std::copy_n(value, tensor_numbers, tensor.begin());
                metrics_.add_matrix(tensor);
            }
        }
    }

    void read_numbers(std::string_view open, std::string_view close, std::vector<double>& numbers,
                      std::size_t count) {
        numbers.clear();
        expect(open);
        do {
            skip_blanks();
            const std::size_t end =
                std::min(text_.find_first_of(",(){}; \t\r\n", at_), text_.size());
            const std::string_view word = text_.substr(at_, end - at_);
            double x = 0;
            if (!parse_number(word, x)) fail(fmt::format("{} is not a number", quote(word)));
            at_ = end;
            numbers.push_back(x);
        } while (accept(","));
        expect(close);
        if (numbers.size() != count) {
            fail(fmt::format("{} numbers instead of {}: of one step in time, and of first order",
                             numbers.size(), count));
        }
    }

    std::string name() {
        expect("\"");
        const std::size_t end = text_.find_first_of("\"\n", at_);
        if (end == std::string_view::npos || text_[end] == '\n') fail("a name without an end");
        std::string name(text_.substr(at_, end - at_));
        at_ = end + 1;
        return name;
    }

    void expect(std::string_view what) {
        if (accept(what)) return;
        const std::string_view rest = text_.substr(at_, 12);
        fail(fmt::format("'{}' expected, {} found", what,
                         rest.empty() ? "the end of the file" : quote(rest)));
    }
    bool accept(std::string_view what) {
        skip_blanks();
        if (!text_.substr(at_).starts_with(what)) return false;
        at_ += what.size();
        return true;
    }

    // Blanks and comments.
    void skip_blanks() {
        while (at_ < text_.size()) {
            const std::string_view rest = text_.substr(at_);
            if (std::string_view(" \t\r\n").find(rest[0]) != std::string_view::npos) {
                ++at_;
            } else if (rest.starts_with("//")) {
                at_ = std::min(text_.find('\n', at_), text_.size());
            } else if (rest.starts_with("/*")) {
                const std::size_t end = text_.find("*/", at_ + 2);
                at_ = end == std::string_view::npos ? text_.size() : end + 2;
            } else {
                return;
            }
        }
    }

    [[noreturn]] void fail(const std::string& what) const {
        const auto end = text_.begin() + static_cast<std::ptrdiff_t>(at_);
        const auto line = 1 + std::count(text_.begin(), end, '\n');
        throw InputError(fmt::format("{}: {}", place(path_, static_cast<std::size_t>(line)), what));
    }

    std::string_view text_;
    const std::filesystem::path& path_;
    const std::string& view_;
    std::size_t at_ = 0;
    std::vector<std::string> names_;
    bool is_found_ = false;
    std::vector<double> places_read_, values_read_;  ///< of one element
    std::vector<Point> places_;
    MetricRows metrics_;
};

std::array<double, 6> numbers_of(const Metric& m) { return {m.xx, m.yy, m.zz, m.xy, m.xz, m.yz}; }

/// Without those that repeat an earlier one.
std::vector<PointSource> without_repeated(const std::vector<PointSource>& sources) {
    std::vector<std::size_t> order(sources.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
        const PointSource &a = sources[i], &b = sources[j];
        if (a.position != b.position) return precedes(a.position, b.position);
        return numbers_of(a.metric) < numbers_of(b.metric);
    });
    std::vector<bool> repeats(sources.size());
    for (std::size_t k = 1; k < order.size(); ++k) {
        repeats[order[k]] = sources[order[k]] == sources[order[k - 1]];
    }
    std::vector<PointSource> kept;
    for (std::size_t i = 0; i < sources.size(); ++i) {
        if (!repeats[i]) kept.push_back(sources[i]);
    }
    return kept;
}

}  // namespace

std::vector<PointSource> read_pos_sources(const std::filesystem::path& path,
                                          const std::string& view) {
    return parse_pos_sources(read_text_file(path), path, view);
}

std::vector<PointSource> parse_pos_sources(std::string_view text, const std::filesystem::path& path,
                                           const std::string& view) {
    return without_repeated(Parser(text, path, view).sources());
}

void write_pos_sources(const std::filesystem::path& path, std::span<const PointSource> sources) {
    const bool isotropic = std::all_of(sources.begin(), sources.end(),
                                       [](const PointSource& s) { return is_isotropic(s.metric); });
    fmt::memory_buffer text;
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "View \"controlspace\" {{\n");
    for (const auto& [p, metric] : sources) {
        fmt::format_to(out, "{}({},{},{})", isotropic ? "SP" : "TP", p.x(), p.y(), p.z());
        if (isotropic) {
            fmt::format_to(out, "{{{}}};\n", metric.xx);
            continue;
        }
        const Metric t = to_riemannian(metric);
        fmt::format_to(out, "{{{},{},{},{},{},{},{},{},{}}};\n", t.xx, t.xy, t.xz, t.xy, t.yy, t.yz,
                       t.xz, t.yz, t.zz);
    }
    fmt::format_to(out, "}};\n");
    OutputFile file(path);
    file.write({text.data(), text.size()});
    file.commit();
}

}  // namespace controlspace
