#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "study/case.h"

namespace controlspace {

/// The words that stand for the values of an enumeration in options, study files and results.
template <class Enum>
struct Names;

template <>
struct Names<SplitRule> {
    static constexpr std::array<std::pair<SplitRule, std::string_view>, 4> table{
        {{SplitRule::middle, "s_L"},
         {SplitRule::golden, "s_G"},
         {SplitRule::exact_golden, "s_Gx"},
         {SplitRule::metric, "s_M"}}};
};
template <>
struct Names<GradationLaw> {
    static constexpr std::array<std::pair<GradationLaw, std::string_view>, 2> table{
        {{GradationLaw::cone, "cone"}, {GradationLaw::mean_length, "mean-length"}}};
};
template <>
struct Names<GradationSchedule> {
    static constexpr std::array<std::pair<GradationSchedule, std::string_view>, 2> table{
        {{GradationSchedule::queue, "queue"}, {GradationSchedule::passes, "passes"}}};
};
template <>
struct Names<Neighbourhood> {
    static constexpr std::array<std::pair<Neighbourhood, std::string_view>, 2> table{
        {{Neighbourhood::faces, "faces"}, {Neighbourhood::all, "all"}}};
};
template <>
struct Names<ReferenceKind> {
    static constexpr std::array<std::pair<ReferenceKind, std::string_view>, 2> table{
        {{ReferenceKind::exact, "exact"}, {ReferenceKind::published_sphere, "published-sphere"}}};
};
template <>
struct Names<Sampling> {
    static constexpr std::array<std::pair<Sampling, std::string_view>, 4> table{
        {{Sampling::regular, "regular"},
         {Sampling::random, "random"},
         {Sampling::clustered, "clustered"},
         {Sampling::poisson, "poisson"}}};
};
template <>
struct Names<FieldKind> {
    static constexpr std::array<std::pair<FieldKind, std::string_view>, 7> table{
        {{FieldKind::none, "none"},
         {FieldKind::sphere, "sphere"},
         {FieldKind::planes, "planes"},
         {FieldKind::ugawg_linear, "ugawg-linear"},
         {FieldKind::ugawg_polar_1, "ugawg-polar-1"},
         {FieldKind::ugawg_polar_2, "ugawg-polar-2"},
         {FieldKind::file, "file"}}};
};

template <>
struct Names<NodeValues> {
    static constexpr std::array<std::pair<NodeValues, std::string_view>, 2> table{
        {{NodeValues::graded, "graded"}, {NodeValues::exact, "exact"}}};
};
template <>
struct Names<Frozen> {
    static constexpr std::array<std::pair<Frozen, std::string_view>, 3> table{
        {{Frozen::no, "no"}, {Frozen::doubles, "doubles"}, {Frozen::floats, "floats"}}};
};

template <class Enum>
constexpr std::string_view name_of(Enum value) {
    for (const auto& [v, name] : Names<Enum>::table) {
        if (v == value) return name;
    }
    return {};
}

template <class Enum>
constexpr std::optional<Enum> from_name(std::string_view text) {
    for (const auto& [v, name] : Names<Enum>::table) {
        if (name == text) return v;
    }
    return std::nullopt;
}

}  // namespace controlspace
