// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

namespace controlspace {

/// A value of an enumeration as it is written in options, study files and results.
template <class Enum>
struct Word {
    Enum value;
    std::string_view name;
    std::string_view meaning;  ///< one line, for `controlspace list`
};

/// To be specialized with `static constexpr Word<Enum> table[]`.
template <class Enum>
struct Words;

template <class Enum>
constexpr std::string_view name_of(Enum value) {
    for (const Word<Enum>& word : Words<Enum>::table) {
        if (word.value == value) return word.name;
    }
    return {};
}

template <class Enum>
constexpr std::optional<Enum> from_name(std::string_view name) {
    for (const Word<Enum>& word : Words<Enum>::table) {
        if (word.name == name) return word.value;
    }
    return std::nullopt;
}

}  // namespace controlspace
