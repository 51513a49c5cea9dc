// SPDX-License-Identifier: Apache-2.0
#include "io/text/pos.h"

#include "fuzz/fuzzing.h"

using namespace controlspace;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    answers([&] { require_valid(parse_pos_sources(as_text(data, size), "f.pos")); });
    return 0;
}
