#include "cli/standard_output.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>

#include "controlspace/error.h"

namespace controlspace {

void keep_standard_places() {
    for (const int place : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        // The lowest that is free; read-only, so that nobody takes it to have been written to.
        if (::fcntl(place, F_GETFD) < 0) ::open("/dev/null", O_RDONLY);
    }
}

void print(std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() ||
        std::fflush(stdout) != 0) {
        throw InputError("standard output cannot be written: check where it is sent to");
    }
}

void print_error(std::string_view text) {
    std::fwrite(text.data(), 1, text.size(), stderr);
    std::fflush(stderr);
}

}  // namespace controlspace
