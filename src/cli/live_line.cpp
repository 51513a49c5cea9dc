#include "cli/live_line.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "cli/standard_output.h"

namespace controlspace {
namespace {

std::size_t terminal_width() {
    winsize size{};
    const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
    return known ? size.ws_col : 80;
}

}  // namespace

void show_live_line(const std::string& text) {
    print_error(fmt::format("\r\033[K{}", text.substr(0, terminal_width() - 1)));
}

void clear_live_line() { print_error("\r\033[K"); }

}  // namespace controlspace
