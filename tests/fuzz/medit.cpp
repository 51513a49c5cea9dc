// SPDX-License-Identifier: Apache-2.0
#include "io/text/medit.h"

#include "fuzz/fuzzing.h"

using namespace controlspace;

// A mesh and a solution at once, text or binary.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view bytes = as_text(data, size);
    answers([&] { parse_medit_vertices(bytes, "f.mesh"); });
    answers([&] {
        for (const Metric& m : parse_medit_metrics(bytes, "f.sol")) {
            require(is_positive_definite(m), "metrics are positive definite");
        }
    });
    answers([&] { require_valid(parse_medit_required_edges(bytes, "f.mesh")); });
    return 0;
}
