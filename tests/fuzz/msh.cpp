// SPDX-License-Identifier: Apache-2.0
#include "io/text/msh.h"

#include "fuzz/fuzzing.h"

using namespace controlspace;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    answers([&] { require_valid(parse_msh_sources(as_text(data, size), "f.msh")); });
    return 0;
}
