// SPDX-License-Identifier: Apache-2.0
#include "io/text/csv.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <string>

#include "files/output_file.h"
#include "files/text_file.h"
#include "io/text/metric_rows.h"
#include "io/text/scanner.h"
#include "refuse.h"

namespace controlspace {
namespace {

constexpr std::array<std::string_view, 20> names{
    "x",    "y",    "z",                                                  // position
    "h",                                                                  // size
    "m_xx", "m_yy", "m_zz", "m_xy", "m_xz", "m_yz",                       // tensor
    "h1",   "h2",   "h3",   "e1x",  "e1y",  "e1z",  "e2x", "e2y", "e2z",  // frame
    "g"                                                                   // growth
};
constexpr std::size_t absent = names.size();

/// Columns that come together: a range of `names`.
struct Columns {
    std::size_t first, count;
    bool operator==(const Columns&) const = default;
};
constexpr Columns position{0, 3}, size{3, 1}, tensor{4, 6}, frame{10, 9};
constexpr std::size_t growth = 19;

std::string_view trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(Scanner::blanks);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(Scanner::blanks) - first + 1);
}

/// The separator of a table, by its first line: the first of these that is not within quotes.
char separator_of(std::string_view line) {
    bool quoted = false;
    for (const char c : line) {
        if (c == '"') quoted = !quoted;
        if (!quoted && (c == ',' || c == ';' || c == '\t')) return c;
    }
    return ',';
}

/// Without the quotes around them, within which separators are letters.
std::vector<std::string_view> fields_of(std::string_view line, char separator) {
    std::vector<std::string_view> fields;
    if (line.find('"') == line.npos) {
        fields = split(line, separator);
    } else {
        bool quoted = false;
        std::size_t begin = 0;
        for (std::size_t i = 0; i <= line.size(); ++i) {
            if (i < line.size() && line[i] == '"') quoted = !quoted;
            if (i < line.size() && (quoted || line[i] != separator)) continue;
            fields.push_back(line.substr(begin, i - begin));
            begin = i + 1;
        }
    }
    for (std::string_view& field : fields) {
        field = trimmed(field);
        if (field.size() > 1 && field.front() == '"' && field.back() == '"') {
            field = trimmed(field.substr(1, field.size() - 2));
        }
    }
    return fields;
}

/// A number as C++ reads it, or with Fortran's exponent (1D-3), or with a decimal comma where that
/// is no separator.
bool read_number(std::string_view field, char separator, double& value) {
    if (parse_number(field, value)) return true;
    std::string text(field);
    for (char& c : text) {
        if (c == 'd' || c == 'D') c = 'e';
        if (c == ',' && separator != ',') c = '.';
    }
    return parse_number(text, value);
}

/// ParaView's names of coordinates.
std::string plain_name(const std::string& name) {
    constexpr std::array<std::string_view, 3> points{"points:", "points_", "point coordinates:"};
    for (const std::string_view begin : points) {
        if (name.size() != begin.size() + 1 || !name.starts_with(begin)) continue;
        const char axis = name.back();
        if (axis >= '0' && axis <= '2') return {static_cast<char>('x' + (axis - '0'))};
    }
    return name;
}

/// The rows of a table as values by name.
class Table {
public:
    using Values = std::array<double, names.size()>;  ///< 0 where there is no such column

    /// Reads the names of the columns; those of metrics are passed over in a table of positions.
    /// `remark` is told the columns that are not read.
    Table(std::string_view text, const std::filesystem::path& path, bool positions_alone,
          const std::function<void(const std::string&)>& remark = {})
        : text_(text, path), positions_alone_(positions_alone) {
        if (const auto line = next_line()) read_names(*line, remark);
    }

    const Columns& form() const { return form_; }
    std::string where() const { return text_.where(); }
    template <class... Args>
    [[noreturn]] void fail(fmt::format_string<Args...> text, Args&&... args) const {
        text_.fail(text, std::forward<Args>(args)...);
    }

    /// The next row that is not blank; none at the end.
    const Values* next() {
        std::vector<std::string_view> fields;
        const auto is_blank = [](std::string_view field) { return field.empty(); };
        do {
            const auto line = next_line();
            if (!line) return nullptr;
            fields = fields_of(*line, separator_);
        } while (std::ranges::all_of(fields, is_blank));
        if (fields.size() != name_of_column_.size()) {
            fail("{} columns instead of {}", fields.size(), name_of_column_.size());
        }
        for (std::size_t column = 0; column < fields.size(); ++column) {
            const std::size_t name = name_of_column_[column];
            if (name == absent) continue;
            if (!read_number(fields[column], separator_, values_[name])) {
                fail("{} = {} is not a number", names[name], quote(fields[column]));
            }
            if (!is_coordinate(values_[name])) {
                fail("{} = {}: give a finite number, of at most {:.0e}", names[name], values_[name],
                     largest_magnitude);
            }
        }
        return &values_;
    }

private:
    /// The next line that is neither blank nor a comment.
    std::optional<std::string_view> next_line() {
        while (!text_.rest().empty()) {
            const std::string_view line = trimmed(text_.line());
            if (!line.empty() && line.front() != '#') return line;
        }
        return std::nullopt;
    }

    void read_names(std::string_view line, const std::function<void(const std::string&)>& remark) {
        separator_ = separator_of(line);
        std::array<bool, names.size()> present{};
        std::vector<std::string> all, others;
        for (const std::string_view field : fields_of(line, separator_)) {
            const std::string name = plain_name(lower_case(std::string(field)));
            auto index = static_cast<std::size_t>(std::find(names.begin(), names.end(), name) -
                                                  names.begin());
            if (positions_alone_ && index >= position.count) index = absent;
            name_of_column_.push_back(index);
            all.push_back(quote(field));
            if (index == absent) {
                others.push_back(quote(field));
                continue;
            }
            if (present[index]) fail("column '{}' is there twice: drop one", name);
            present[index] = true;
        }
        if (all.size() > most_named) all.resize(most_named);
        for (const Columns& c : {position, size, tensor, frame}) {
            const auto begin = present.begin() + static_cast<std::ptrdiff_t>(c.first);
            const auto end = begin + static_cast<std::ptrdiff_t>(c.count);
            if (c != position && std::find(begin, end, true) == end) continue;
            if (const auto missing = std::find(begin, end, false); missing != end) {
                fail("column '{}' is missing{} ({})",
                     names[static_cast<std::size_t>(missing - present.begin())],
                     c == position ? ": name the columns in the first line"
                                   : " beside the others of its kind",
                     fmt::join(all, ", "));
            }
            if (c == position) continue;
            if (form_.count > 0) {
                fail("two ways to give the metric: keep h, or m_xx..m_yz, or h1..e2z");
            }
            form_ = c;
        }
        if (!positions_alone_ && form_.count == 0) {
            fail("no metric: add a column h, or m_xx..m_yz, or h1..e2z ({})", fmt::join(all, ", "));
        }
        if (remark && !positions_alone_ && !others.empty()) {
            const std::size_t left = others.size() - std::min(others.size(), most_named);
            others.resize(others.size() - left);
            remark(fmt::format("{}: columns that are not read: {}{}", text_.path().string(),
                               fmt::join(others, ", "),
                               left > 0 ? fmt::format(" and {} more", left) : ""));
        }
    }

    static constexpr std::size_t most_named = 20;  ///< columns in a message

    Scanner text_;
    bool positions_alone_;
    char separator_ = ',';
    std::vector<std::size_t> name_of_column_;  ///< index into `names`, or absent
    Columns form_{0, 0};
    Values values_{};
};

Metric metric_in_frame(std::span<const double> v, const Table& table) {
    constexpr double orthogonal = 1e-3;
    const Vector e1 = Vector(v[3], v[4], v[5]).stableNormalized();
    const Vector given = Vector(v[6], v[7], v[8]).stableNormalized();
    if (!(e1.norm() > 0.5 && given.norm() > 0.5)) {
        table.fail("direction e1 or e2 is zero: give two directions");
    }
    if (std::abs(e1.dot(given)) > orthogonal) {
        table.fail("e1 and e2 are not orthogonal: the cosine of their angle is {:.3g}",
                   e1.dot(given));
    }
    const Vector e2 = (given - e1.dot(given) * e1).normalized();
    Eigen::Matrix3d directions;
    directions << e1, e2, e1.cross(e2);
    const Metric m = metric_from_frame({v[0], v[1], v[2]}, directions);
    if (!is_source_metric(m)) table.fail("lengths h1, h2, h3 differ by more than numbers can hold");
    return m;
}

[[noreturn]] void fail_empty(const std::filesystem::path& path, std::string_view what) {
    refuse("{} holds no {}: add some lines", path.string(), what);
}

}  // namespace

std::vector<PointSource> parse_csv_sources(std::string_view text, const std::filesystem::path& path,
                                           const ReadOptions& options) {
    Table table(text, path, /*positions_alone=*/false, options.remark);
    // In place, as there may be as many as fit into memory.
    std::vector<PointSource> sources;
    sources.reserve(static_cast<std::size_t>(std::ranges::count(text, '\n')));
    MetricRows metrics([&] { return table.where(); }, length_tensor);
    while (const Table::Values* row = table.next()) {
        PointSource& source = sources.emplace_back();
        source.position = Point(row->data());
        source.growth = (*row)[growth];
        if (!is_source_growth(source.growth)) table.fail("g = {}: {}", source.growth, growth_rule);
        std::span<const double> v = std::span(*row).subspan(table.form().first);
        const std::size_t lengths = table.form() == size ? 1 : table.form() == frame ? 3 : 0;
        for (std::size_t i = 0; i < lengths; ++i) {
            if (is_length(v[i])) continue;
            table.fail("{} = {}: {}", names[table.form().first + i], v[i], length_rule);
        }
        if (table.form() == size) {
            source.metric = Metric::isotropic(v[0]);
        } else if (table.form() == frame) {
            const auto numbers = numbers_of(metric_in_frame(v, table), length_tensor);
            metrics.add(std::span(numbers).first(length_tensor.numbers));
        } else {
            metrics.add(v.first(table.form().count));
        }
    }
    if (sources.empty()) fail_empty(path, "sources");
    if (table.form() != size) {
        const std::vector<Metric> tensors = metrics.take();
        for (std::size_t i = 0; i < sources.size(); ++i) sources[i].metric = tensors[i];
    }
    return sources;
}

std::vector<PointSource> read_csv_sources(const std::filesystem::path& path,
                                          const ReadOptions& options) {
    return parse_csv_sources(read_text_file(path), path, options);
}

std::string csv_line_of(const std::filesystem::path& path, std::size_t index) {
    const std::string text = read_text_file(path);
    Table table(text, path, /*positions_alone=*/false);
    for (std::size_t i = 0; i <= index; ++i) table.next();
    const std::string where = table.where();
    return where.substr(where.rfind(':') + 1);
}

std::vector<Point> parse_csv_points(std::string_view text, const std::filesystem::path& path) {
    Table table(text, path, /*positions_alone=*/true);
    std::vector<Point> points;
    while (const Table::Values* row = table.next()) points.emplace_back(row->data());
    if (points.empty()) fail_empty(path, "points");
    return points;
}

std::vector<Point> read_csv_points(const std::filesystem::path& path) {
    return parse_csv_points(read_text_file(path), path);
}

void write_csv_sources(const std::filesystem::path& path, std::span<const PointSource> sources) {
    const bool isotropic = all_isotropic(sources);
    const bool alike = std::ranges::all_of(sources, [](const auto& s) { return s.growth == 0; });
    OutputFile file(path);
    file.write(isotropic ? "x,y,z,h" : "x,y,z,m_xx,m_yy,m_zz,m_xy,m_xz,m_yz");
    file.write(alike ? "\n" : ",g\n");
    for (const auto& [p, m, own_growth] : sources) {
        const auto numbers = numbers_of(m, length_tensor);
        file.print("{},{},{},{}", p.x(), p.y(), p.z(),
                   fmt::join(std::span(numbers).first(isotropic ? 1 : tensor.count), ","));
        if (!alike) file.print(",{}", own_growth);
        file.write("\n");
    }
    file.commit();
}

}  // namespace controlspace
