// SPDX-License-Identifier: Apache-2.0
#include "controlspace/study/study.h"

#include "controlspace/baselines/catalogue.h"
#include "fuzz/fuzzing.h"

using namespace controlspace;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    answers([&] {
        const Study study = parse_study(as_text(data, size), "f.toml");
        expand(study, {.structures = structures()});
    });
    return 0;
}
