// SPDX-License-Identifier: Apache-2.0
#include "io/text/csv.h"

#include "fuzz/fuzzing.h"

using namespace controlspace;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text = as_text(data, size);
    answers([&] { require_valid(parse_csv_sources(text, "f.csv")); });
    answers([&] {
        for (const Point& p : parse_csv_points(text, "f.csv")) {
            require(p.allFinite(), "places are finite");
        }
    });
    return 0;
}
