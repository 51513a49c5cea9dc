// SPDX-License-Identifier: Apache-2.0
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>

// As -w NoAssertions on each command line: a test that asserts nothing cannot fail, and so fails.
int main(int argc, char** argv) {
    Catch::Session session;
    session.configData().warnings = Catch::WarnAbout::NoAssertions;
    return session.run(argc, argv);
}
