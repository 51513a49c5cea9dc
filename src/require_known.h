// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include "controlspace/error.h"

namespace controlspace {

/// Throws InputError, naming the option, for a value of an enumeration that is none of those up to
/// `last`: it was cast from a number.
template <class Enumeration>
void require_known(const char* name, Enumeration value, Enumeration last) {
    if (value < Enumeration{} || value > last) {
        throw InputError(
            fmt::format("{} is {}: give one of its named values", name, static_cast<int>(value)));
    }
}

}  // namespace controlspace
