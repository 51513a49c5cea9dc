// SPDX-License-Identifier: Apache-2.0
#include "mesh/mmg_mesher.h"

#include <catch2/catch.hpp>
#include <chrono>
#include <cstdlib>
#include <thread>

#include "controlspace/fields/formula_field.h"
#include "controlspace/mesh/conformity.h"
#include "editable_space.h"
#include "mesh/fixtures.h"
#include "sources/files.h"

namespace controlspace::mmg_mesher_test {

using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

const FormulaField uniform([](const Point&) { return Metric::isotropic(0.5); });

/// Two cells a side, with a part of its boundary.
TetMesh start_mesh() {
    TetMesh mesh = kuhn_mesh(2);
    mesh.triangles = {{0, 1, 4}, {0, 3, 4}};
    return mesh;
}

/// What stands for MMG: a shell script.
fs::path fake_mmg(const ScratchDirectory& folder, const std::string& commands) {
    const fs::path script = folder.file("fake", "#!/bin/sh\n" + commands + "\n");
    fs::permissions(script, fs::perms::owner_all);
    return script;
}

std::string error_with(const ScratchDirectory& folder, const fs::path& program,
                       const ControlSpace& field = uniform, double time_limit_s = 60) {
    return error_of([&] {
        mesh_with_mmg(start_mesh(), field,
                      {.program = program, .time_limit_s = time_limit_s, .folder = folder.path()});
    });
}

std::vector<fs::path> left_folders(const ScratchDirectory& folder) {
    std::vector<fs::path> folders;
    for (const auto& entry : fs::directory_iterator(folder.path())) {
        if (entry.is_directory()) folders.push_back(entry.path());
    }
    return folders;
}

bool is_running(int process) {
    std::ifstream status("/proc/" + std::to_string(process) + "/status");
    const std::string text(std::istreambuf_iterator<char>(status), {});
    return !text.empty() && text.find("State:\tZ") == std::string::npos;
}

/// MMG as the tests are told of it, or as it is found.
fs::path real_mmg() {
    const char* told = std::getenv("CONTROLSPACE_MMG");
    return told == nullptr ? find_mmg() : fs::path(told);
}

}  // namespace

TEST_CASE("each round goes on from the mesh of the one before, and no file is left") {
    const ScratchDirectory folder;
    // Gives back what it was given, and counts how often it was called.
    const auto program = fake_mmg(folder, "echo x >> ../calls; cp in.mesh out.mesh");
    const MeshRun run = mesh_with_mmg(start_mesh(), uniform,
                                      {.program = program, .rounds = 2, .folder = folder.path()});
    CHECK(fs::file_size(folder.path() / "calls") == 2 * 2);
    CHECK(run.mesh.vertices == start_mesh().vertices);
    CHECK(run.mesh.triangles == start_mesh().triangles);
    CHECK(run.mesh.tets == start_mesh().tets);
    CHECK(run.cost.queries == 2 * run.mesh.vertices.size());
    CHECK(left_folders(folder).empty());
}

TEST_CASE("what goes wrong with MMG is said with its last words, and its files are kept") {
    const ScratchDirectory folder;
    const auto [commands, expected] = GENERATE(table<std::string, std::string>({
        {"echo reading; echo ' metric not SPD at 3 '; echo; exit 2",
         "failed with status 2: reading | metric not SPD at 3"},
        {"echo done", "left no mesh that can be read"},
        {"echo MeshVersionFormatted 2 Dimension 3 Vertices 7 > out.mesh", "out.mesh"},
        {"printf 'MeshVersionFormatted 2\\nDimension 3\\nVertices\\n4\\n0 0 0 0\\n1 0 0 0\\n0 1 0 "
         "0\\n0 0 1 0\\nTriangles\\n1\\n1 2 5 0\\nTetrahedra\\n1\\n1 2 3 4 0\\nEnd\\n' > out.mesh",
         "Triangles 1: 5 is not one of 1 to 4"},
        {"kill -SEGV $$", "was ended by signal 11: it printed nothing (its files: "},
    }));
    CAPTURE(commands);
    const std::string error = error_with(folder, fake_mmg(folder, commands));
    CHECK_THAT(error, Contains(expected) && Contains("MMG "));
    const auto left = left_folders(folder);
    REQUIRE(left.size() == 1);
    CHECK_THAT(error, Contains(left.front().string()));
    CHECK(fs::exists(left.front() / "in.sol"));
    CHECK(fs::exists(left.front() / "log"));
}

TEST_CASE("an MMG that hangs is ended, with what it started") {
    const ScratchDirectory folder;
    const auto program = fake_mmg(folder, "sleep 1000 & echo $! > ../child; wait");
    CHECK_THAT(error_with(folder, program, uniform, 0.5), Contains("took longer than 0.5 s"));
    int child = 0;
    std::ifstream(folder.path() / "child") >> child;
    REQUIRE(child > 1);
    // It dies when the system comes to it, and may stay as a zombie that no one waits for.
    for (int i = 0; is_running(child) && i < 1000; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    CHECK_FALSE(is_running(child));
}

TEST_CASE("an MMG that is not there, or no program, is named") {
    const ScratchDirectory folder;
    CHECK_THAT(error_with(folder, folder.path() / "none"), Contains("none: no program"));
    CHECK_THAT(error_with(folder, folder.file("text", "no program")), Contains("no program"));
    const fs::path odd = folder.file("odd",
                                     "\x7f"
                                     "ELF nothing");
    fs::permissions(odd, fs::perms::owner_all);
    CHECK_THAT(error_with(folder, odd), Contains("is it a program"));
    CHECK_THAT(error_of([&] {
                   mesh_with_mmg(kuhn_mesh(1), uniform,
                                 {.program = "/bin/true", .folder = folder.path() / "none"});
               }),
               Contains("cannot make a folder"));
    CHECK_THAT(error_of([&] {
                   mesh_with_mmg(kuhn_mesh(1), uniform, {.program = "/bin/true", .rounds = 0});
               }),
               Contains("0 rounds"));
}

TEST_CASE("MMG is not started on a field that is no metric") {
    const ScratchDirectory folder;
    const FormulaField wrong([](const Point&) { return Metric{1, 1, -1, 0, 0, 0}; });
    CHECK_THAT(error_with(folder, fake_mmg(folder, "touch ../called"), wrong),
               Contains("is no metric: (1 1 -1 0 0 0)"));
    CHECK_FALSE(fs::exists(folder.path() / "called"));
}

TEST_CASE("MMG follows an anisotropic field") {
    const fs::path program = real_mmg();
    if (program.empty()) {
        WARN("skipped: no mmg3d (CONTROLSPACE_MMG names it)");
        SUCCEED("no mmg3d");
        return;
    }
    const ScratchDirectory folder;
    // Thin along a skew direction.
    const Vector normal = Vector(1, 2, 2) / 3;
    const FormulaField thin([&](const Point& p) {
        const double across = 0.06 + 0.1 * std::abs((p - Point::Constant(0.5)).dot(normal));
        return layer_metric(normal, across, 4 * across);
    });
    const MeshRun run =
        mesh_with_mmg(kuhn_mesh(3), thin, {.program = program, .folder = folder.path()});
    CHECK(volume(run.mesh) == Approx(1));
    CHECK(area(run.mesh) == Approx(6));
    const Conformity c = conformity(run.mesh, thin);
    CHECK(c.l_r > 0.55);
    CHECK(c.unit_share > 0.75);
    CHECK(c.quality_mean > 0.7);
    CHECK(left_folders(folder).empty());
}

}  // namespace controlspace::mmg_mesher_test
