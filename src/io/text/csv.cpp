#include "io/text/csv.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>

#include "controlspace/error.h"
#include "io/text/indefinite_tensors.h"
#include "io/text/metric_rows.h"
#include "io/text/output_file.h"
#include "io/text/text_file.h"

namespace controlspace {

namespace {

// All names, by form: x y z, then those of one form after the other.
constexpr std::array<std::string_view, 19> names{
    "x",    "y",    "z",                                                 // position
    "h",                                                                 // isotropic
    "m_xx", "m_yy", "m_zz", "m_xy", "m_xz", "m_yz",                      // tensor
    "h1",   "h2",   "h3",   "e1x",  "e1y",  "e1z",  "e2x", "e2y", "e2z"  // frame
};

enum class Form { isotropic, tensor, frame };

struct Columns {
    std::size_t first, count;  ///< of `names`
};
constexpr Columns position_columns{0, 3};
constexpr Columns columns_of(Form form) {
    switch (form) {
        case Form::isotropic:
            return {3, 1};
        case Form::tensor:
            return {4, 6};
        case Form::frame:
            break;
    }
    return {10, 9};
}

constexpr std::size_t absent = names.size();

struct Header {
    std::vector<std::size_t> name_of_column;  ///< index into `names`, or absent, by column
    Form form = Form::isotropic;
};

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view blanks = " \t\r";
    const std::size_t first = text.find_first_not_of(blanks);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

// Takes the text up to the next `separator` off the front of `rest`.
std::string_view take(std::string_view& rest, char separator) {
    const std::size_t end = std::min(rest.find(separator), rest.size());
    const std::string_view piece = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    return piece;
}

class Parser {
public:
    Parser(std::string_view text, const std::filesystem::path& path) : rest_(text), path_(path) {}

    std::vector<PointSource> sources() {
        std::vector<PointSource> all;
        std::vector<std::size_t> indefinite;
        for_each_row("sources", [&](const Values& v) {
            all.push_back(
                {{v[0], v[1], v[2]}, metric(std::span(v).subspan(columns_of(header_.form).first))});
            if (is_indefinite_) indefinite.push_back(all.size());
        });
        if (!indefinite.empty()) {
            std::vector<Metric> metrics;
            for (const PointSource& source : all) metrics.push_back(source.metric);
            throw IndefiniteTensors(first_indefinite_, std::move(metrics), std::move(indefinite));
        }
        return all;
    }

    std::vector<Point> points() {
        positions_alone_ = true;
        std::vector<Point> all;
        for_each_row("points", [&](const Values& v) { all.emplace_back(v[0], v[1], v[2]); });
        return all;
    }

private:
    using Values = std::array<double, names.size()>;  ///< 0 where there is no such column

    template <class Take>
    void for_each_row(std::string_view what, Take&& take_row) {
        std::string_view line;
        bool any = false;
        if (next_line(line)) {
            read_header(line);
            for (; next_line(line); any = true) take_row(values(line));
        }
        if (!any) {
            throw InputError(fmt::format("{} holds no {}: add some lines", path_.string(), what));
        }
    }

    // The next line that says something.
    bool next_line(std::string_view& line) {
        while (!rest_.empty()) {
            line = trimmed(take(rest_, '\n'));
            ++line_number_;
            if (!line.empty() && line.front() != '#') return true;
        }
        return false;
    }

    void read_header(std::string_view line) {
        std::array<bool, names.size()> present{};
        bool more = true;
        while (more) {
            more = line.find(',') != std::string_view::npos;
            std::string name(trimmed(take(line, ',')));
            for (char& c : name) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 'a' - 'A') : c;
            const auto index = static_cast<std::size_t>(
                std::find(names.begin(), names.end(), name) - names.begin());
            if (positions_alone_ && index >= position_columns.count) {
                header_.name_of_column.push_back(absent);
                continue;
            }
            if (index == absent) {
                fail(fmt::format("column {} is none of {}: name the columns in the first line",
                                 quote(name), fmt::join(names, " ")));
            }
            if (present[index]) fail(fmt::format("column '{}' is there twice: drop one", name));
            present[index] = true;
            header_.name_of_column.push_back(index);
        }
        const auto missing = [&](Columns c) -> std::optional<std::string_view> {
            for (std::size_t i = c.first; i < c.first + c.count; ++i) {
                if (!present[i]) return names[i];
            }
            return std::nullopt;
        };
        if (const auto name = missing(position_columns)) {
            fail(fmt::format("column '{}' is missing: give x, y and z", *name));
        }
        if (positions_alone_) return;
        std::optional<Form> form;
        for (const Form f : {Form::isotropic, Form::tensor, Form::frame}) {
            const Columns c = columns_of(f);
            const auto begin = present.begin() + static_cast<std::ptrdiff_t>(c.first);
            if (std::find(begin, begin + static_cast<std::ptrdiff_t>(c.count), true) ==
                begin + static_cast<std::ptrdiff_t>(c.count)) {
                continue;
            }
            if (form) fail("two ways to give the metric: keep h, or m_xx..m_yz, or h1..e2z");
            if (const auto name = missing(c)) {
                fail(fmt::format("column '{}' is missing beside the others of its kind", *name));
            }
            form = f;
        }
        if (!form) fail("no metric: add a column h, or m_xx..m_yz, or h1..e2z");
        header_.form = *form;
    }

    Values values(std::string_view line) {
        Values value{};
        const std::size_t columns = header_.name_of_column.size();
        std::string_view rest = line;
        for (std::size_t column = 0; column < columns; ++column) {
            const bool last = column + 1 == columns;
            if (last == (rest.find(',') != std::string_view::npos)) {
                fail(fmt::format("{} columns instead of {}",
                                 1 + std::count(line.begin(), line.end(), ','), columns));
            }
            const std::string_view field = trimmed(take(rest, ','));
            const std::size_t name = header_.name_of_column[column];
            if (name == absent) continue;
            if (!parse_number(field, value[name])) {
                fail(fmt::format("{} = {} is not a number", names[name], quote(field)));
            }
            if (!is_coordinate(value[name])) {
                fail(fmt::format("{} = {}: give a finite number, of at most {:.0e}", names[name],
                                 value[name], largest_magnitude));
            }
        }
        return value;
    }

    Metric metric(std::span<const double> v) {
        switch (header_.form) {
            case Form::isotropic:
                check_length("h", v[0]);
                return Metric::isotropic(v[0]);
            case Form::tensor: {
                const Metric m{v[0], v[1], v[2], v[3], v[4], v[5]};
                is_indefinite_ = !is_source_metric(m);
                if (is_indefinite_ && first_indefinite_.empty()) {
                    first_indefinite_ = at_line(
                        fmt::format("tensor {} is not positive definite: its eigenvalues are "
                                    "lengths, and must be positive",
                                    to_string(m)));
                }
                return m;
            }
            case Form::frame:
                break;
        }
        check_length("h1", v[0]);
        check_length("h2", v[1]);
        check_length("h3", v[2]);
        constexpr double orthogonal = 1e-3;
        const Vector e1 = Vector(v[3], v[4], v[5]).stableNormalized();
        const Vector given = Vector(v[6], v[7], v[8]).stableNormalized();
        if (!(e1.norm() > 0.5 && given.norm() > 0.5)) {
            fail("direction e1 or e2 is zero: give two directions");
        }
        if (std::abs(e1.dot(given)) > orthogonal) {
            fail(fmt::format("e1 and e2 are not orthogonal: the cosine of their angle is {:.3g}",
                             e1.dot(given)));
        }
        const Vector e2 = (given - e1.dot(given) * e1).normalized();
        Eigen::Matrix3d frame;
        frame << e1, e2, e1.cross(e2);
        const Metric m = metric_from_frame({v[0], v[1], v[2]}, frame);
        if (!is_source_metric(m)) fail("lengths h1, h2, h3 differ by more than numbers can hold");
        return m;
    }

    void check_length(std::string_view name, double h) {
        if (!is_length(h)) {
            fail(fmt::format("{} = {}: {}", name, h, length_rule));
        }
    }

    [[noreturn]] void fail(const std::string& what) const { throw InputError(at_line(what)); }
    std::string at_line(const std::string& what) const {
        return fmt::format("{}: {}", place(path_, line_number_), what);
    }

    std::string_view rest_;
    const std::filesystem::path& path_;
    std::size_t line_number_ = 0;
    bool positions_alone_ = false;
    Header header_;
    bool is_indefinite_ = false;    // the last tensor
    std::string first_indefinite_;  // what is said of it
};

}  // namespace

std::vector<PointSource> read_csv_sources(const std::filesystem::path& path) {
    return parse_csv_sources(read_text_file(path), path);
}

std::vector<PointSource> parse_csv_sources(std::string_view text,
                                           const std::filesystem::path& path) {
    return Parser(text, path).sources();
}

std::vector<Point> read_csv_points(const std::filesystem::path& path) {
    return Parser(read_text_file(path), path).points();
}

void write_csv_sources(const std::filesystem::path& path, std::span<const PointSource> sources) {
    OutputFile file(path);
    const bool isotropic = std::all_of(sources.begin(), sources.end(),
                                       [](const PointSource& s) { return is_isotropic(s.metric); });
    file.write(isotropic ? "x,y,z,h\n" : "x,y,z,m_xx,m_yy,m_zz,m_xy,m_xz,m_yz\n");
    fmt::memory_buffer line;
    for (const PointSource& source : sources) {
        const Point& p = source.position;
        const Metric& m = source.metric;
        line.clear();
        auto out = std::back_inserter(line);
        fmt::format_to(out, "{},{},{},{}", p.x(), p.y(), p.z(), m.xx);
        if (!isotropic) {
            fmt::format_to(out, ",{},{},{},{},{}", m.yy, m.zz, m.xy, m.xz, m.yz);
        }
        line.push_back('\n');
        file.write({line.data(), line.size()});
    }
    file.commit();
}

}  // namespace controlspace
