// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <catch2/catch.hpp>
#include <string>

#include "controlspace/error.h"
#include "scratch_directory.h"

namespace controlspace {

/// What the InputError of `action` says, one line; "" if there is none.
template <class Action>
std::string error_of(Action&& action) {
    try {
        action();
    } catch (const InputError& error) {
        const std::string what = error.what();
        CHECK(what.find('\n') == std::string::npos);
        return what;
    }
    return "";
}

}  // namespace controlspace
