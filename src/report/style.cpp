#include "report/style.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "report/figure.h"

namespace controlspace {
namespace {

// Okabe and Ito's palette for all kinds of colour vision, without yellow, which is lost on white.
constexpr std::array colours{"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                             "#E69F00", "#56B4E9", "#000000"};
// gnuplot's circle, square, triangles and diamond, filled and open: as many as share no divisor
// with the colours, so that 70 structures differ.
constexpr std::array marks{7, 5, 9, 11, 13, 6, 4, 8, 10, 12};

}  // namespace

Styles::Styles(std::span<const Row> rows) {
    for (const Row& row : rows) {
        const std::string& id = row.setting.structure;
        if (std::find(structures_.begin(), structures_.end(), id) == structures_.end()) {
            structures_.push_back(id);
        }
    }
}

std::size_t Styles::index(const Case& c) const {
    const auto found = std::find(structures_.begin(), structures_.end(), c.structure);
    return static_cast<std::size_t>(found - structures_.begin());
}

std::string Styles::colour(const Case& c) const {
    return fmt::format("linecolor rgb '{}'", colours[index(c) % colours.size()]);
}

std::string Styles::mark(const Case& c) const {
    return fmt::format("pointtype {} {}", marks[index(c) % marks.size()], colour(c));
}

std::string Styles::dashes(const Case& c) {
    const SplitRule split = c.split.value_or(SplitRule::middle);
    return fmt::format("dashtype {}", split == SplitRule::middle   ? 1
                                      : split == SplitRule::metric ? 3
                                                                   : 2);
}

void Range::add(double x) {
    if (!(x > 0) || !std::isfinite(x)) return;
    const bool first = low == 0;
    low = first ? x : std::min(low, x);
    high = first ? x : std::max(high, x);
}

std::string log_tics(double low, double high) {
    const double ratio = high / low;
    const std::vector<double> digits =
        ratio > 1000 ? std::vector<double>{1}
        : ratio > 4  ? std::vector<double>{1, 2, 5}
                     : std::vector<double>{1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8};
    std::string tics;
    for (int power = static_cast<int>(std::floor(std::log10(low))); std::pow(10, power) <= high;
         ++power) {
        for (const double digit : digits) {
            const double tic = digit * std::pow(10, power);
            if (tic < low || tic > high) continue;
            tics += fmt::format("{}'{:.7g}' {:.7g}", tics.empty() ? "" : ", ", tic, tic);
        }
    }
    return "(" + tics + ")";
}

int height_of(std::size_t lines, int line) {
    constexpr std::size_t most = 12000;  // the PNG is larger, and cairo ends at 32767
    return static_cast<int>(std::min(most, 150 + lines * static_cast<std::size_t>(line)));
}

std::string log_axis(std::string_view axis, const Range& given, std::string_view label) {
    const Range range = given.low > 0 ? given : Range{1, 1};
    const double room = std::max(1.3, std::pow(range.high / range.low, 0.06));
    const double low = range.low / room;
    const double high = range.high * room;
    return fmt::format(
        "set logscale {0}\nset {0}range [{1:.6g}:{2:.6g}]\nset {0}tics {3}\n"
        "set {0}label {4}\n",
        axis, low, high, log_tics(low, high), gnuplot_string(label));
}

}  // namespace controlspace
