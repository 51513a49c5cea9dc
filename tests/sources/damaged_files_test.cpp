// SPDX-License-Identifier: Apache-2.0
// Readers of sources on files that were damaged.
#include "damaged_files.h"

#include <catch2/catch.hpp>

#include "controlspace/io/read_sources.h"
#include "io/text/csv.h"
#include "scratch_directory.h"

namespace controlspace::damaged_files_test {
namespace {

std::vector<PointSource> sources(bool isotropic) {
    std::vector<PointSource> all;
    for (int i = 0; i < 12; ++i) {
        const double t = 0.1 * i;
        Metric metric{0.3 + t, 0.4, 0.5, 0.02, -0.03, 0.05};
        if (isotropic) metric = Metric::isotropic(0.25 + t);
        all.push_back({Point(t, 1 - t, t * t), metric});
    }
    return all;
}

void read_any(const std::filesystem::path& file) { read_sources(file); }

}  // namespace

TEST_CASE("damaged files of sources end in sources or in an error, with little memory") {
    const ScratchDirectory scratch("damaged");
    const bool isotropic = GENERATE(true, false);
    const std::string name = GENERATE("d.csv", "d.mesh", "d.sol", "d.meshb", "d.solb", "d.pos");
    write_sources(scratch / name, sources(isotropic));
    check_damaged_files(scratch.path(), name, file_text(scratch / name), 200, read_any);
}

TEST_CASE("damaged tables of frames and of places do too") {
    const ScratchDirectory scratch("damaged");
    const std::string frames =
        "x,y,z,h1,h2,h3,e1x,e1y,e1z,e2x,e2y,e2z\n0,0,0,1,2,3,1,0,0,0,1,0\n"
        "1,0.5,0,1,2,3,0,0,2,1,1,0\n";
    check_damaged_files(scratch.path(), "f.csv", frames, 200, read_any);
    check_damaged_files(scratch.path(), "p.csv", "name,z,y,x\na,0,0,0\nb,0,0,0.2\n\nc,1,1,1\n", 200,
                        [](const std::filesystem::path& file) { read_csv_points(file); });
}

}  // namespace controlspace::damaged_files_test
