// SPDX-License-Identifier: Apache-2.0
#include "cli/standard_output.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>

#include "controlspace/study/results.h"
#include "refuse.h"

namespace controlspace {

void occupy_standard_descriptors() {
    for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        // open() returns the lowest free number. Read-only: writing fails rather than being lost.
        if (::fcntl(descriptor, F_GETFD) < 0) ::open("/dev/null", O_RDONLY);
    }
}

void print(std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() ||
        std::fflush(stdout) != 0) {
        refuse("standard output cannot be written: check where it is sent to");
    }
}

void print_to(const std::filesystem::path& output, std::string_view text) {
    if (output == "/dev/stdout") return print(text);
    replace_file(output, text);
}

void print_error(std::string_view text) {
    std::fwrite(text.data(), 1, text.size(), stderr);
    std::fflush(stderr);
}

}  // namespace controlspace
