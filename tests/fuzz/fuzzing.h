// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include "controlspace/error.h"
#include "controlspace/metric/metric.h"
#include "controlspace/sources/point_source.h"

namespace controlspace {

/// Ends the program, which libFuzzer reports together with the input.
inline void require(bool holds, std::string_view what) {
    if (holds) return;
    std::cerr << "\nviolated: " << what << "\n";
    std::abort();
}

/// read() ends in an answer, or in an InputError of one line. Whether it has answered.
template <class Read>
bool answers(const Read& read) {
    try {
        read();
        return true;
    } catch (const InputError& error) {
        const std::string_view what = error.what();
        require(!what.empty() && what.find('\n') == what.npos, "an error is one line");
        return false;
    }
}

inline void require_valid(const std::vector<PointSource>& sources) {
    for (const PointSource& s : sources) {
        require(s.position.allFinite(), "positions are finite");
        require(is_positive_definite(s.metric), "metrics are positive definite");
    }
}

inline std::string_view as_text(const std::uint8_t* data, std::size_t size) {
    return {reinterpret_cast<const char*>(data), size};
}

}  // namespace controlspace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
