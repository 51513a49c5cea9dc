#define CATCH_CONFIG_RUNNER
#include <tbb/global_control.h>

#include <catch2/catch.hpp>
#include <iostream>

// CTest splits lists at semicolons, and would not run a test with one in its name. Listed in place
// of all tests of the program, the complaint is a test that fails.
int main(int argc, char** argv) {
    for (const auto& test : Catch::getRegistryHub().getTestCaseRegistry().getAllTests()) {
        std::string name = test.name;
        if (name.find(';') == std::string::npos) continue;
        std::replace(name.begin(), name.end(), ';', ' ');
        std::cout << "no semicolon in the name of a test: " << name << '\n';
        return 1;
    }
#ifdef __SANITIZE_THREAD__
    // The system's TBB is built without the thread sanitizer, which does not see that TBB hands
    // tasks from thread to thread, and would report whatever they touch. So loops in parallel run
    // on the thread that calls them; threads that tests start are checked in full.
    const tbb::global_control alone(tbb::global_control::max_allowed_parallelism, 1);
#endif
    return Catch::Session().run(argc, argv);
}
