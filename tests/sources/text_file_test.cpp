// SPDX-License-Identifier: Apache-2.0
#include "files/text_file.h"

#include <signal.h>
#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <thread>

#include "controlspace/io/read_sources.h"
#include "files/output_file.h"
#include "sources/files.h"

namespace controlspace::text_file_test {

using Catch::Matchers::Contains;

namespace {

/// A named pipe that another thread writes `text` into, as long as it is read.
class Pipe {
public:
    Pipe(const std::filesystem::path& path, const std::string& text)
        : made_(::mkfifo(path.c_str(), 0600)), writer_([=] {
              // A reader that stops before the end must not end the program.
              sigset_t broken_pipe;
              sigemptyset(&broken_pipe);
              sigaddset(&broken_pipe, SIGPIPE);
              pthread_sigmask(SIG_BLOCK, &broken_pipe, nullptr);
              std::ofstream(path) << text;
          }) {}
    ~Pipe() { writer_.join(); }
    bool is_made() const { return made_ == 0; }

private:
    int made_;
    std::thread writer_;
};

}  // namespace

TEST_CASE("a pipe is read to its end") {
    const ScratchDirectory scratch;
    const std::string text(200'000, 'x');
    const Pipe pipe(scratch.path() / "pipe", text);
    REQUIRE(pipe.is_made());
    CHECK(read_text_file(scratch.path() / "pipe") == text);
}

TEST_CASE("sources come through a pipe as CSV, whatever its name") {
    const ScratchDirectory scratch;
    const Pipe pipe(scratch.path() / "63", "x,y,z,h\n1,2,3,4\n5,6,7,8\n");
    REQUIRE(pipe.is_made());
    CHECK(read_sources(scratch.path() / "63").size() == 2);
}

TEST_CASE("what does not end is refused at the limit") {
    const ScratchDirectory scratch;
    const Pipe pipe(scratch.path() / "pipe", std::string(300'000, 'x'));
    REQUIRE(pipe.is_made());
    CHECK_THAT(error_of([&] { read_text_file(scratch.path() / "pipe", 200'000); }),
               Contains("pipe does not end after 200000 bytes"));
}

TEST_CASE("a file on disk may be longer than the limit: its size is known") {
    const ScratchDirectory scratch;
    const std::string text(300'000, 'x');
    CHECK(read_text_file(scratch.file("long", text), 1000) == text);
}

TEST_CASE("a zero byte is in no text, wherever it stands") {
    const ScratchDirectory scratch;
    CHECK_THAT(error_of([] { read_text_file("/dev/zero"); }), Contains("/dev/zero holds a zero"));
    CHECK_THAT(error_of([] { read_sources("/dev/zero"); }), Contains("/dev/zero holds a zero"));
    std::string text(100'000, 'x');
    text.back() = '\0';
    CHECK_THAT(error_of([&] { read_text_file(scratch.file("late", text)); }),
               Contains("late holds a zero byte: give a text file"));
}

TEST_CASE("a file that is replaced leaves its mode to the new one") {
    const ScratchDirectory folder;
    const auto path = folder.path() / "a.txt";
    const auto mode = [&] { return std::filesystem::status(path).permissions(); };
    const auto write = [&](const std::filesystem::path& to) {
        OutputFile file(to);
        file.write("new");
        file.commit();
    };
    using std::filesystem::perms;
    for (const perms wanted : {perms(0600), perms(0640), perms(0666), perms(0755)}) {
        std::ofstream(path) << "old";
        std::filesystem::permissions(path, wanted);
        write(path);
        CHECK(mode() == wanted);
        CHECK(read_text_file(path) == "new");
    }
    std::filesystem::create_symlink(path, folder.path() / "link");
    std::filesystem::permissions(path, perms(0600));
    write(folder.path() / "link");
    CHECK(std::filesystem::is_symlink(folder.path() / "link"));
    CHECK(mode() == perms(0600));

    std::ofstream(path) << "old";
    std::filesystem::permissions(path, perms(0444));
    CHECK_THAT(error_of([&] { write(path); }), Contains("a.txt: it is write-protected"));
    CHECK(read_text_file(path) == "old");
    CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 2);
}

}  // namespace controlspace::text_file_test
