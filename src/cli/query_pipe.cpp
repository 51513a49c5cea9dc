#include "cli/query_pipe.h"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <span>
#include <system_error>
#include <vector>

#include "controlspace/error.h"

namespace controlspace {
namespace {

using Place = std::array<double, 3>;

[[noreturn]] void fail(const char* what) {
    throw InputError(fmt::format("{}: {}", what, std::generic_category().message(errno)));
}

/// What is there to read, and at least one byte; 0 at the end.
std::size_t read_some(std::span<char> bytes) {
    for (;;) {
        const ssize_t count = ::read(STDIN_FILENO, bytes.data(), bytes.size());
        if (count >= 0) return static_cast<std::size_t>(count);
        if (errno != EINTR) fail("standard input cannot be read");
    }
}

void write_all(std::span<const double> lengths) {
    auto bytes = std::as_bytes(lengths);
    while (!bytes.empty()) {
        const ssize_t count = ::write(STDOUT_FILENO, bytes.data(), bytes.size());
        if (count < 0 && errno != EINTR) fail("standard output cannot be written");
        if (count > 0) bytes = bytes.subspan(static_cast<std::size_t>(count));
    }
}

}  // namespace

void answer_places(const ControlSpace& space) {
    constexpr std::size_t at_once = 4096;
    std::vector<char> bytes(at_once * sizeof(Place));
    std::vector<Point> places;
    std::vector<double> lengths;
    std::size_t filled = 0;
    while (const std::size_t count = read_some(std::span(bytes).subspan(filled))) {
        filled += count;
        places.clear();
        bool ends = false;
        std::size_t used = 0;
        for (; !ends && filled - used >= sizeof(Place); used += sizeof(Place)) {
            Place x;
            std::memcpy(x.data(), bytes.data() + used, sizeof x);
            const Point place(x.data());
            ends = place.hasNaN();
            if (!ends) places.push_back(place);
        }
        lengths.resize(places.size());
        space.sample_lengths(places, lengths);
        write_all(lengths);
        if (ends) return;
        std::memmove(bytes.data(), bytes.data() + used, filled - used);
        filled -= used;
    }
    if (filled > 0) {
        throw InputError(
            fmt::format("the last place has {} of {} bytes: send three doubles for each", filled,
                        sizeof(Place)));
    }
}

}  // namespace controlspace
