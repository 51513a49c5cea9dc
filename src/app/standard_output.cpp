#include "app/standard_output.h"

#include <cstdio>

#include "error.h"

namespace controlspace {

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
