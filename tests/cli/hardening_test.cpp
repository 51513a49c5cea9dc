// What the compiler and the linker do against files that try to take over the program.
#include <catch2/catch.hpp>

#include "cli/sandbox.h"

using namespace controlspace;
using Catch::Matchers::Contains;

#ifdef _FORTIFY_SOURCE  // optimized builds alone
TEST_CASE("the program checks its buffers and stacks, and can be loaded anywhere") {
    const Sandbox box("hardening");
    REQUIRE(box.run("--version", "readelf -dlW --dyn-syms '" CONTROLSPACE_APP "' > elf; ").status ==
            0);
    const std::string elf = file_text(box / "elf");
    CHECK_THAT(elf, Contains("Flags: NOW PIE") && Contains("GNU_RELRO"));
    CHECK_THAT(elf, Contains("__stack_chk_fail") && Contains("_chk@GLIBC"));
    CHECK_THAT(elf, !Contains("RWE"));
}
#endif
