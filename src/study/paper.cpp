#include "study/paper.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "controlspace/error.h"
#include "study/names.h"

namespace controlspace {
namespace {

/// Fields of one line, separated by commas.
std::vector<std::string_view> fields(std::string_view line) {
    std::vector<std::string_view> result;
    while (true) {
        const std::size_t comma = line.find(',');
        result.push_back(line.substr(0, comma));
        if (comma == std::string_view::npos) return result;
        line.remove_prefix(comma + 1);
    }
}

constexpr std::string_view header =
    "structure,split,rho,tau,size_MB,creation_s,access_us,"
    "delta_R_max,L_R";

PaperRow parse_row(std::string_view line, std::size_t line_number) {
    const auto text = fields(line);
    const auto fail = [&](std::string_view what) {
        throw InputError(fmt::format("paper's tables, line {}: {}", line_number, what));
    };
    if (text.size() != 9) fail("give nine fields");
    PaperRow row;
    row.structure = text[0];
    row.split = from_name<SplitRule>(text[1]);
    if (!row.split && !text[1].empty()) fail(fmt::format("unknown split '{}'", text[1]));
    const std::array<double*, 7> values{&row.rho,        &row.tau,       &row.size_mb,
                                        &row.creation_s, &row.access_us, &row.delta_r_max,
                                        &row.l_r};
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::string_view t = text[i + 2];
        const auto [end, error] = std::from_chars(t.data(), t.data() + t.size(), *values[i]);
        if (error != std::errc() || end != t.data() + t.size()) {
            fail(fmt::format("'{}' is not a number", t));
        }
    }
    return row;
}

/// The settings that all of the paper's tables share.
bool is_paper_setting(const Case& c) {
    SourcesChoice sphere;
    sphere.rho = c.sources.rho;
    Case paper;
    return c.sources == sphere && c.g_r == paper.g_r && c.epsilon == paper.epsilon &&
           c.max_depth == (c.split ? 42 : 14);
}

}  // namespace

std::vector<PaperRow> parse_paper_tables(std::string_view csv) {
    std::vector<PaperRow> rows;
    bool seen_header = false;
    for (std::size_t line_number = 1; !csv.empty(); ++line_number) {
        const std::size_t end = std::min(csv.find('\n'), csv.size());
        const std::string_view line = csv.substr(0, end);
        csv.remove_prefix(std::min(end + 1, csv.size()));
        if (line.empty() || line.front() == '#') continue;
        if (seen_header) {
            rows.push_back(parse_row(line, line_number));
        } else if (line == header) {
            seen_header = true;
        } else {
            throw InputError(fmt::format("paper's tables, line {}: the header should be {}",
                                         line_number, header));
        }
    }
    return rows;
}

std::span<const PaperRow> paper_rows() {
    static const std::vector<PaperRow> rows = parse_paper_tables(paper_tables_text());
    return rows;
}

const PaperRow* paper_row(const Case& c) {
    if (!is_paper_setting(c)) return nullptr;
    for (const PaperRow& row : paper_rows()) {
        if (row.structure == c.structure && row.split == c.split && row.rho == c.sources.rho &&
            row.tau == c.tau) {
            return &row;
        }
    }
    return nullptr;
}

}  // namespace controlspace
