// SPDX-License-Identifier: Apache-2.0
// Uses the library as installed: every structure of the catalogue, and its errors.
#include <controlspace/baselines/catalogue.h>
#include <controlspace/error.h>
#include <controlspace/sources/sampled_surfaces.h>
#include <controlspace/version.h>

#include <cstdio>
#include <string_view>

using namespace controlspace;

namespace {

int failures = 0;

void check(bool holds, std::string_view what) {
    if (holds) return;
    std::printf("failed: %.*s\n", static_cast<int>(what.size()), what.data());
    ++failures;
}

}  // namespace

int main(int argc, char** argv) {
    check(argc == 2 && version() == argv[1], "the package's version is the library's");
    const Box domain{Point(-1, -1, -1), Point(1, 1, 1)};
    const PointSource source{Point(0.3, 0.2, 0.1), Metric::isotropic(0.05)};
    for (const CatalogueEntry& entry : structures()) {
        const auto builder = entry.make({.domain = domain, .finest_length = 0.05});
        builder->insert(source);
        builder->grade({.ratio = 1.25});
        const auto space = builder->build();
        const double here = sample_at(*space, source.position).xx;
        const double there = sample_at(*space, Point(-0.9, -0.9, -0.9)).xx;
        check(here < 0.08 && there > 0.2, entry.id);
        try {
            builder->insert(PointSource{Point(2, 0, 0), Metric::isotropic(0.05)});
            check(false, "a source outside is refused");
        } catch (const InputError&) {
        }
    }
    return failures == 0 ? 0 : 1;
}
