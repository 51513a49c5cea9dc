// SPDX-License-Identifier: Apache-2.0
// controlspace-peers knows the rows of foreign systems in every command; controlspace does not.
#include <catch2/catch.hpp>

#include "cli/sandbox.h"
#include "peers/peers.h"

namespace controlspace::program_test {
namespace {

bool has_nanoflann() {
    if (find_entry(peer_rows(), "kd-nearest") != nullptr) return true;
    WARN("skipped: this build has no nanoflann");
    SUCCEED("no nanoflann");
    return false;
}

}  // namespace

TEST_CASE("controlspace-peers lists and compares foreign systems") {
    const Sandbox sandbox("peers");
    const Outcome listed = sandbox.run("list");
    for (const CatalogueEntry& row : peer_rows()) {
        CHECK(listed.out.find("  " + row.id + " ") != std::string::npos);
    }
    const Outcome unknown = sandbox.run("compare sphere --structures K_X -o none");
    CHECK(unknown.status == 2);
    CHECK(unknown.err.find("a family (trees, further, anchored, baselines, peers)") !=
          std::string::npos);
    sandbox.write("s.csv", "x,y,z,h\n0,0,0,0.1\n1,0,0,0.2\n0,1,1,0.2\n");
    const Outcome compared = sandbox.run(
        "compare s.csv --structures peers --access-points 1000 --access-repeats 1 -o r");
    CHECK(compared.status == 0);
    const std::string results = file_text(sandbox / "r/results.csv");
    for (const CatalogueEntry& row : peer_rows()) {
        CHECK(results.find(row.id) != std::string::npos);
    }
}

TEST_CASE("a tensor stops a system of lengths, and the others go on") {
    if (!has_nanoflann()) return;
    const Sandbox sandbox("peers-tensor");
    sandbox.write(
        "s.csv",
        "x,y,z,m_xx,m_yy,m_zz,m_xy,m_xz,m_yz\n0,0,0,0.2,0.2,0.1,0,0,0\n1,1,1,0.2,0.2,0.2,0,0,0\n");
    const Outcome compared = sandbox.run(
        "compare s.csv --structures kd-nearest,K_oL --access-points 1000 --access-repeats 1 -o r");
    CHECK(compared.status == 3);
    const std::string results = file_text(sandbox / "r/results.json");
    CHECK(results.find("give isotropic sources") != std::string::npos);
    CHECK(results.find("K_oL") != std::string::npos);
}

TEST_CASE("controlspace itself neither knows nor links foreign systems") {
    const Sandbox sandbox("main");
    sandbox.run("--version", "'" CONTROLSPACE_MAIN
                             "' list > list.txt; "
                             "ldd '" CONTROLSPACE_MAIN "' > libraries.txt;");
    const std::string listed = file_text(sandbox / "list.txt");
    const std::string libraries = file_text(sandbox / "libraries.txt");
    CHECK(libraries.find("libtbb") != std::string::npos);
    for (const char* peer : {"netgen", "p4est", "mpi", "CGAL", "gmsh"}) {
        CHECK(libraries.find(peer) == std::string::npos);
    }
    CHECK(listed.find("K_oL") != std::string::npos);
    for (const CatalogueEntry& row : peer_rows()) CHECK(listed.find(row.id) == std::string::npos);
}

}  // namespace controlspace::program_test
