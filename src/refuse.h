// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "controlspace/error.h"

namespace controlspace {

/// Throws InputError with the formatted text.
template <class... Args>
[[noreturn]] void refuse(fmt::format_string<Args...> text, Args&&... args) {
    throw InputError(fmt::format(text, std::forward<Args>(args)...));
}

/// The same with the place of the error, a file or a line of one, in front: "place: text".
template <class... Args>
[[noreturn]] void refuse_at(const std::filesystem::path& place, fmt::format_string<Args...> text,
                            Args&&... args) {
    refuse("{}: {}", place.string(), fmt::format(text, std::forward<Args>(args)...));
}

}  // namespace controlspace
