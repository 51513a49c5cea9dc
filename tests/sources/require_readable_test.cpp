// SPDX-License-Identifier: Apache-2.0
// Files read in a child process first: what the child says and what it survives.
#include "controlspace/io/require_readable.h"

#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <string>

#include "controlspace/error.h"
#include "files/child_process.h"
#include "sources/files.h"

namespace controlspace::require_readable_test {
namespace {

/// A file of four bytes.
class TextFile {
public:
    TextFile() { std::ofstream(path()) << "text"; }
    std::filesystem::path path() const { return folder_ / "a.txt"; }

private:
    ScratchDirectory folder_;
};

}  // namespace

TEST_CASE("A reader's errors come from the child process, and its success is silent") {
    const TextFile file;
    CHECK_NOTHROW(require_readable(file.path(), [&] {
        std::string word;
        std::ifstream(file.path()) >> word;
        if (word != "text") throw InputError("cannot read");
    }));
    CHECK_THROWS_WITH(require_readable(file.path(), [] { throw InputError("line 3: no number"); }),
                      "line 3: no number");
}

TEST_CASE("A reader that crashes, ends or fails is an error that names the file") {
    const TextFile file;
    const auto error = [&](const std::function<void()>& read) {
        return error_of([&] { require_readable(file.path(), read); });
    };
    const std::string damaged =
        file.path().string() +
        ": the library that reads such files fails on it: is it damaged, or cut off?";
    CHECK(error([] { std::raise(SIGSEGV); }) == damaged);
    CHECK(error([] { std::abort(); }) == damaged);
    CHECK(error([] { std::_Exit(3); }) == damaged);
    CHECK(error([] { throw 1; }) == damaged);
}

TEST_CASE("How a child ends is known where the caller ignores or does not keep its children") {
    const TextFile file;
    struct sigaction before {};
    struct sigaction ignoring {};
    ignoring.sa_handler = GENERATE(true, false) ? SIG_IGN : SIG_DFL;
    ignoring.sa_flags = SA_NOCLDWAIT;
    ::sigaction(SIGCHLD, &ignoring, &before);
    CHECK_NOTHROW(require_readable(file.path(), [] {}));
    CHECK_THROWS_WITH(require_readable(file.path(), [] { throw InputError("no"); }), "no");
    CHECK_THAT(error_of([&] { require_readable(file.path(), [] { std::abort(); }); }),
               Catch::Matchers::Contains("is it damaged"));
    const auto log = file.path().parent_path() / "log";
    const auto ran = [&](const std::string& command) {
        return run_child({"/bin/sh", "-c", command}, file.path().parent_path(), log, 60);
    };
    CHECK(ran("exit 0").succeeded());
    CHECK(ran("exit 5").status == 5);
    CHECK(ran("kill -SEGV $$").signal == SIGSEGV);
    CHECK(run_child({"/bin/sleep", "60"}, file.path().parent_path(), log, 0.05).timed_out);
    struct sigaction after {};
    ::sigaction(SIGCHLD, &before, &after);
    CHECK(after.sa_handler == ignoring.sa_handler);
    CHECK((after.sa_flags & SA_NOCLDWAIT) != 0);
}

TEST_CASE("A child that another part of the program collects has not succeeded") {
    const auto before = std::signal(SIGCHLD, [](int) {
        while (::waitpid(-1, nullptr, WNOHANG) > 0) {
        }
    });
    const TextFile file;
    const ChildOutcome outcome = run_child({"/bin/sh", "-c", "exit 5"}, "/", file.path(), 60);
    CHECK_FALSE(outcome.succeeded());
    std::signal(SIGCHLD, before);
}

TEST_CASE("Pipes are refused, which libraries would wait for") {
    const ScratchDirectory folder;
    const auto pipe = folder.path() / "a.vtu";
    REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
    CHECK_THAT(error_of([&] { require_readable(pipe, [] { FAIL("was read"); }); }),
               Catch::Matchers::Contains("a.vtu: a pipe or a device"));
}

TEST_CASE("Where no file can be opened, the error says so") {
    const TextFile file;
    rlimit before{};
    ::getrlimit(RLIMIT_NOFILE, &before);
    const rlimit none{3, before.rlim_max};
    ::setrlimit(RLIMIT_NOFILE, &none);
    const std::string error = error_of([&] { require_readable(file.path(), [] {}); });
    ::setrlimit(RLIMIT_NOFILE, &before);
    CHECK_THAT(error, Catch::Matchers::Contains("a.txt: no process can be started to read it: Too "
                                                "many open files"));
}

TEST_CASE("A reader that crashes ends, whatever the program does when it crashes itself") {
    const TextFile file;
    for (const int signal : {SIGSEGV, SIGABRT}) {
        const auto before = std::signal(signal, [](int) { ::pause(); });
        CHECK_THROWS_AS(require_readable(file.path(), [&] { std::raise(signal); }), InputError);
        std::signal(signal, before);
    }
}

// The address sanitizer's allocator may be locked by another thread when the child is forked.
#ifndef __SANITIZE_ADDRESS__
TEST_CASE("A reader that works in parallel ends, though threads of the program are not there") {
    const TextFile file;
    const auto work = [] {
        constexpr int steps = 10'000;
        std::atomic<int> done = 0;
        tbb::parallel_for(0, steps, [&](int) { ++done; });
        if (done != steps) throw InputError("work is missing");
    };
    for (int time = 0; time < 1000; ++time) {
        work();
        CHECK_NOTHROW(require_readable(file.path(), [&] {
            for (int again = 0; again < 20; ++again) work();
        }));
    }
}
#endif

}  // namespace controlspace::require_readable_test
