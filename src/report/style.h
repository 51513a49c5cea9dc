#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "study/row.h"

namespace controlspace {

/// Errors below it are drawn at the lower edge: on a logarithmic axis 0 has no place.
constexpr double smallest_drawn_error = 1e-4;

/// How the structures of a report are told apart: each has one colour and one mark in all its
/// pictures.
class Styles {
public:
    /// In the order in which structures occur in `rows`.
    explicit Styles(std::span<const Row> rows);

    /// "linecolor rgb '#0072B2'".
    std::string colour(const Case& c) const;
    /// "pointtype 7 linecolor rgb '#0072B2'".
    std::string mark(const Case& c) const;
    /// Solid, but dashed for s_G and dotted for s_M: "dashtype 1".
    static std::string dashes(const Case& c);

private:
    std::size_t index(const Case& c) const;

    std::vector<std::string> structures_;
};

/// Smallest and largest value of an axis.
struct Range {
    double low = 0;
    double high = 0;

    /// Widens it so that it holds `x`; the first one makes it.
    void add(double x);
};

/// gnuplot's list of tics for a logarithmic axis from `low` to `high`: every power of ten or, where
/// these are few, 1, 2 and 5 times them.
std::string log_tics(double low, double high);

/// gnuplot's commands for a logarithmic axis ("x", "y") over `range` with some room beside it.
std::string log_axis(std::string_view axis, const Range& range, std::string_view label);

}  // namespace controlspace
