// SPDX-License-Identifier: Apache-2.0
#include "io/text/pos.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>

#include "files/output_file.h"
#include "files/text_file.h"
#include "io/text/metric_rows.h"
#include "io/text/scanner.h"
#include "refuse.h"

namespace controlspace {
namespace {

/// Corners of an element of that letter; 0 for a letter that is none.
std::size_t corners_of(char letter) {
    constexpr std::string_view letters = "PLTQSHIY";
    constexpr std::array<std::size_t, 8> corners{1, 2, 3, 4, 4, 8, 6, 5};
    const std::size_t i = letters.find(letter);
    return i < corners.size() ? corners[i] : 0;
}

class Parser {
public:
    Parser(std::string_view text, const std::filesystem::path& path, const ReadOptions& options)
        : text_(text, path, "//"),
          options_(options),
          metrics_([&] { return text_.where(); }, matrix_rows) {}

    std::vector<PointSource> sources() {
        for (text_.skip_blanks(); !text_.rest().empty(); text_.skip_blanks()) {
            text_.expect("View");
            read_view();
        }
        if (names_.empty()) text_.fail("no View: give a list view of Gmsh");
        chosen_array(text_.path(), "views", names_, options_.array);
        if (places_.empty()) refuse("{} holds no sources: add some", text_.path().string());
        return sources_from(places_, metrics_.take());
    }

private:
    void read_view() {
        const std::string its_name = name();
        if (std::find(names_.begin(), names_.end(), its_name) == names_.end()) {
            names_.push_back(its_name);
        }
        const std::string& wanted = options_.array;
        const bool is_chosen = wanted.empty() ? names_.size() == 1 : its_name == wanted;
        text_.expect("{");
        while (!text_.accept("}")) {
            if (text_.accept("TIME")) {
                read_numbers("{", "}", values_);
                text_.expect(";");
            } else {
                read_element(is_chosen);
            }
        }
        text_.accept(";");
    }

    void read_element(bool is_chosen) {
        const std::string_view word = text_.rest().substr(0, 2);
        const bool is_scalar = word.starts_with('S');
        const std::size_t corners = word.size() == 2 ? corners_of(word[1]) : 0;
        if ((!is_scalar && !word.starts_with('T')) || corners == 0) {
            text_.fail("{} is no element of scalars or tensors (SP, TP, SS, TS and such)",
                       quote(word));
        }
        text_.expect(word);
        const std::size_t numbers = is_scalar ? 1 : matrix_rows.numbers;
        read_numbers("(", ")", coordinates_);
        require_count(coordinates_, 3 * corners);
        read_numbers("{", "}", values_);
        const std::size_t in_step = numbers * corners;
        if (is_chosen && steps_ == 0) choose_step(values_.size() / in_step);
        if (is_chosen) require_count(values_, in_step * steps_);
        const auto where = [&] { return text_.where(); };
        for (std::size_t i = 0; i < corners; ++i) {
            const Point x(&coordinates_[3 * i]);
            require_coordinates(x, "corner", i + 1, where);
            if (!is_chosen) continue;
            places_.push_back(x);
            metrics_.add(std::span(values_).subspan(in_step * step_ + numbers * i, numbers));
        }
        text_.expect(";");
    }

    /// Of the first element of the chosen view, which has values in so many steps in time.
    void choose_step(std::size_t count) {
        steps_ = std::max<std::size_t>(count, 1);
        std::vector<std::uint64_t> numbers(steps_);
        std::iota(numbers.begin(), numbers.end(), 0);
        step_ = chosen_step(text_.path(), names_.back(), numbers, options_.step, options_.remark);
    }

    void read_numbers(std::string_view open, std::string_view close, std::vector<double>& numbers) {
        numbers.clear();
        text_.expect(open);
        do {
            numbers.push_back(text_.number<double>("an element", ",(){}; \t\r\n"));
        } while (text_.accept(","));
        text_.expect(close);
    }

    void require_count(const std::vector<double>& numbers, std::size_t count) const {
        if (numbers.size() == count) return;
        text_.fail("{} numbers instead of {}: of first order, and of {} {} in time", numbers.size(),
                   count, std::max<std::size_t>(steps_, 1), steps_ > 1 ? "steps" : "step");
    }

    std::string name() {
        text_.expect("\"");
        const std::size_t end = std::min(text_.rest().find_first_of("\"\n"), text_.rest().size());
        std::string name(text_.rest().substr(0, end));
        if (!text_.rest().substr(end).starts_with('"')) text_.fail("a name without an end");
        text_.go_to(text_.at() + end + 1);
        return name;
    }

    Scanner text_;
    const ReadOptions& options_;
    std::vector<std::string> names_;
    std::vector<double> coordinates_, values_;  ///< of one element
    std::size_t steps_ = 0;                     ///< of the chosen view; 0: not known yet
    std::size_t step_ = 0;                      ///< place of the chosen one
    std::vector<Point> places_;
    MetricRows metrics_;
};

}  // namespace

std::vector<PointSource> parse_pos_sources(std::string_view text, const std::filesystem::path& path,
                                           const ReadOptions& options) {
    std::vector<PointSource> sources = Parser(text, path, options).sources();
    drop_repeated(sources);
    return sources;
}

std::vector<PointSource> read_pos_sources(const std::filesystem::path& path,
                                          const ReadOptions& options) {
    return parse_pos_sources(read_text_file(path), path, options);
}

void write_pos_sources(const std::filesystem::path& path, std::span<const PointSource> sources) {
    const bool isotropic = all_isotropic(sources);
    OutputFile file(path);
    file.write("View \"controlspace\" {\n");
    for (const auto& [p, m, growth] : sources) {
        const auto numbers = isotropic ? std::array<double, 9>{m.xx} : numbers_of(m, matrix_rows);
        file.print("{}({},{},{}){{{}}};\n", isotropic ? "SP" : "TP", p.x(), p.y(), p.z(),
                   fmt::join(std::span(numbers).first(isotropic ? 1 : 9), ","));
    }
    file.write("};\n");
    file.commit();
}

}  // namespace controlspace
