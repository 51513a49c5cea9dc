#pragma once

#include <cstddef>
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

/// Smallest and largest value of a logarithmic axis.
struct Range {
    double low = 0;
    double high = 0;

    /// Widens it so that it holds `x`, and passes over what has no place on such an axis: what is
    /// not positive or not finite. The first one makes it.
    void add(double x);
};

/// gnuplot's list of tics for a logarithmic axis from `low` to `high`: every power of ten and, the
/// fewer these are, the more places between them.
std::string log_tics(double low, double high);

/// The height of a picture [pixels] with `lines` lines of `line` pixels each, beside its frame; no
/// larger than can be drawn, however many there are.
int height_of(std::size_t lines, int line);

/// gnuplot's commands for a logarithmic axis ("x", "y") over `given`, or around 1 where that is
/// empty, with some room beside it.
std::string log_axis(std::string_view axis, const Range& given, std::string_view label);

}  // namespace controlspace
