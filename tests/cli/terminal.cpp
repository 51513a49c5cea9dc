// SPDX-License-Identifier: Apache-2.0
#include "cli/terminal.h"

#include <poll.h>
#include <pty.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <stdexcept>

namespace controlspace {

Outcome run_on_terminal(const Sandbox& box, const std::string& arguments, const std::string& word) {
    const std::string folder = (box / "").string();
    const std::string command =
        "cd '" + folder + "' && exec '" CONTROLSPACE_APP "' " + arguments + " >.out";
    const winsize size{.ws_row = 24, .ws_col = 200, .ws_xpixel = 0, .ws_ypixel = 0};
    int terminal = -1;
    const pid_t child = forkpty(&terminal, nullptr, nullptr, &size);
    if (child < 0) throw std::runtime_error("no terminal");
    if (child == 0) {
        execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
        _exit(9);
    }

    Outcome outcome;
    bool typed = word.empty();
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(5);
    // Reading fails once nobody has the terminal open.
    for (ssize_t got = 1; got > 0 && std::chrono::steady_clock::now() < end;) {
        pollfd ready{terminal, POLLIN, 0};
        if (poll(&ready, 1, 100) == 0) continue;
        std::array<char, 4096> piece;
        got = read(terminal, piece.data(), piece.size());
        if (got > 0) outcome.err.append(piece.data(), static_cast<std::size_t>(got));
        if (typed || outcome.err.find(word) == std::string::npos) continue;
        constexpr char ctrl_c = '\x03';
        typed = write(terminal, &ctrl_c, 1) == 1;
    }
    close(terminal);
    kill(child, SIGKILL);  // which does nothing to what has ended
    int status = 0;
    waitpid(child, &status, 0);
    if (WIFEXITED(status)) outcome.status = WEXITSTATUS(status);
    outcome.out = file_text(box / ".out");
    return outcome;
}

}  // namespace controlspace
