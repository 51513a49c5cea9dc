// SPDX-License-Identifier: Apache-2.0
// What stands between a user and a library: the time of `sample_lengths`, and of `length_at` one
// place after the other, over that of a plain loop over the library itself (of an array, for
// uniform grids), on the same sources and places. Samples are taken in turns; printed is the median
// of their ratios, with its quartiles. Fails where answers differ.
//   peers_overhead [NUMBER OF PLACES [SAMPLES]]
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "bare_loops.h"
#include "baselines/peers/peer_rows.h"
#include "controlspace/baselines/catalogue.h"
#include "controlspace/sources/sampled_surfaces.h"
#include "controlspace/space/catalogue.h"
#include "measure/stopwatch.h"

namespace {

using namespace controlspace;

std::unique_ptr<ControlSpace> finished(const CatalogueEntry& row,
                                       std::span<const PointSource> sources) {
    SpaceOptions options;
    options.domain = bare_domain;
    options.finest_length = finest_length(sources);
    options.voxel = bare_voxel;
    const auto builder = row.make(options);
    builder->insert(sources);
    builder->grade({.ratio = 1 + bare_slope});
    if (row.has<CompactForm>()) return builder->build({.precision = Precision::floats});
    return builder->build();
}

double seconds(const auto& work) {
    const Stopwatch time;
    work();
    return time.seconds();
}

/// Returns whether both answer alike, which a ratio needs to mean anything.
bool compare(const std::string& id, const ControlSpace& space, const Loop& bare,
             std::span<const Point> x, int samples) {
    std::vector<double> ours(x.size()), theirs(x.size());
    const auto plain = [&] { bare(x, theirs); };
    const auto in_batches = [&] { space.sample_lengths(x, ours); };
    const auto one_by_one = [&] {
        for (std::size_t i = 0; i < x.size(); ++i) ours[i] = space.length_at(x[i]);
    };
    double apart = 0;
    const auto take_turns = [&](const std::string& name, const auto& adapted) {
        adapted();
        plain();
        for (std::size_t i = 0; i < x.size(); ++i) {
            apart = std::max(apart, std::abs(ours[i] / theirs[i] - 1));
        }
        std::vector<double> ratios;
        for (int i = 0; i < samples; ++i) {
            const double a = seconds(adapted);
            ratios.push_back(a / seconds(plain));
        }
        std::ranges::sort(ratios);
        const auto at = [&](double share) {
            return ratios[static_cast<std::size_t>(share * static_cast<double>(ratios.size() - 1))];
        };
        fmt::print("{:26} {:11} {:6.2f}  {:5.2f} - {:5.2f}  {:.1e}\n", id, name, at(0.5), at(0.25),
                   at(0.75), apart);
    };
    take_turns("in batches", in_batches);
    take_turns("one by one", one_by_one);
    return apart < 1e-5;
}

}  // namespace

int main(int argc, char** argv) {
    const std::size_t count = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 100000;
    const int samples = argc > 2 ? std::atoi(argv[2]) : 21;
    if (count == 0 || samples <= 0) {
        fmt::print(stderr, "peers_overhead: give numbers above 0: [PLACES [SAMPLES]]\n");
        return 2;
    }
    const std::vector<PointSource> sources =
        sample_sphere({.h = 0.05, .s_a = 2, .s_n = 1, .rho = 2});
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> along(-0.98, 0.98);
    std::vector<Point> x(count);
    for (Point& p : x) p = Point(along(random), along(random), along(random));

    std::vector<CatalogueEntry> rows = peer_rows();
    rows.insert(rows.end(), structures().begin(), structures().end());
    bool alike = true;
    const auto against = [&](const std::string& id, const auto& bare) {
        const auto space = finished(*find_entry(rows, id), sources);
        alike = compare(id, *space, bare(*space), x, samples) && alike;
    };
    fmt::print("{:38} median  quartiles      largest difference\n", "time / that of a bare loop");
    against("uniform-nearest", [](const ControlSpace& s) { return bare_array<0>(s); });
    against("uniform-trilinear", [](const ControlSpace& s) { return bare_array<1>(s); });
    against("openvdb-uniform-nearest", [](const ControlSpace& s) { return bare_openvdb<0>(s); });
    against("openvdb-uniform-trilinear", [](const ControlSpace& s) { return bare_openvdb<1>(s); });
    against("kd-nearest", [&](const ControlSpace&) { return bare_nanoflann(sources); });
    against("nanovdb-nearest", [](const ControlSpace& s) { return bare_nanovdb<0>(s); });
    against("nanovdb-trilinear", [](const ControlSpace& s) { return bare_nanovdb<1>(s); });
    against("netgen-localh", [&](const ControlSpace&) { return bare_netgen(sources); });
    const auto octree = finished(*find_entry(tree_catalogue(), "K_oL"), sources);
    against("p4est-octree", [&](const ControlSpace&) { return bare_p4est(*octree); });
    const auto tets = finished(*find_entry(rows, "tets-linear"), sources);
    against("tets-linear", [&](const ControlSpace& s) { return bare_tets(s, sources); });
    against("gmsh-structured", [](const ControlSpace& s) { return bare_structured(s); });
    against("gmsh-view", [&](const ControlSpace&) { return bare_view(*tets, sources); });
    return alike ? 0 : 1;
}
