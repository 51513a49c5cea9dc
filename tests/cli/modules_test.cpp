// SPDX-License-Identifier: Apache-2.0
// External libraries are loaded by the work that needs them, and by no other.
#include <catch2/catch.hpp>
#include <string>

#include "cli/sandbox.h"

namespace controlspace::modules_test {

using Catch::Matchers::Contains;

namespace {

const std::string sources_csv = "x,y,z,h\n0,0,0,0.1\n1,0,0,0.2\n0,1,0,0.2\n1,1,1,0.4\n";

/// Names of the files that the dynamic linker loads for a run of the program.
std::string loaded_files(const Sandbox& box, const std::string& arguments) {
    const Outcome outcome = box.run(arguments, "LD_DEBUG=files ");
    CHECK(outcome.status == 0);
    REQUIRE_THAT(outcome.err, Contains("file=libfmt"));
    return outcome.err;
}

}  // namespace

TEST_CASE("work that needs no external library loads none") {
    const Sandbox box("modules-none");
    box.write("s.csv", sources_csv);
    for (const char* arguments :
         {"--version", "--help", "list", "info s.csv", "convert s.csv s.mesh",
          "convert s.csv a.vtu", "export s.csv -o a.htg",
          "build s.csv -o a.ctrl --structures uniform-nearest",
          "compare --sources s.csv --structures K_oL,direct --access-points 10 --probe-grid 3 "
          "--fine-probe-grid 3 --quiet"}) {
        CAPTURE(arguments);
        const std::string files = loaded_files(box, arguments);
        for (const char* name : {"openvdb", "libvtk", "gmsh", "libgmp", "libmpfr", "libboost"}) {
            CHECK(files.find(std::string("file=") + name) == files.npos);
            CHECK(files.find(std::string("file=lib") + name) == files.npos);
        }
    }
}

#ifdef CONTROLSPACE_VTK
TEST_CASE("a module that is missing, or is no module, is an error of one line") {
    const Sandbox box("modules-missing");
    box.write("s.csv", sources_csv);
    REQUIRE(box.run("convert s.csv a.vtu").status == 0);
    CHECK_THAT(loaded_files(box, "info a.vtu"), Contains("file=libvtk"));
    fs::create_directory(box / "bin");
    const std::string copy =
        "cp -f '" CONTROLSPACE_APP "' bin; bin/controlspace info a.vtu >.out 2>.err; exit $?; ";
    const Outcome missing = box.run("", copy);
    check_refused(missing, "controlspace/vtk.so: no such file");
    const std::string message = missing.err;
    const std::size_t at = message.find('/');
    const fs::path module = message.substr(at, message.find(": no such file") - at);
    fs::create_directories(module.parent_path());
    box.write(fs::relative(module, fs::canonical(box / "")).string(), "not a library");
    check_refused(box.run("", copy), "vtk.so: ");
}
#endif

}  // namespace controlspace::modules_test
