// SPDX-License-Identifier: Apache-2.0
#include "cli/signals.h"

#include <fmt/format.h>
#include <pthread.h>
#include <signal.h>

#include <cstdlib>
#include <exception>
#include <utility>

#include "cli/standard_output.h"

namespace controlspace {
namespace {

sigset_t ending_signals() {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGINT);
    sigaddset(&set, SIGTERM);
    return set;
}

}  // namespace

Interruption::Interruption() {
    const sigset_t set = ending_signals();
    pthread_sigmask(SIG_BLOCK, &set, nullptr);
    thread_ = std::jthread([this](const std::stop_token& stop) { wait(stop); });
}

Interruption::~Interruption() {
    thread_.request_stop();
    thread_.join();
    const sigset_t set = ending_signals();
    pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
}

Interruption::Watch::Watch(Interruption& interruption, std::function<void()> tick,
                           std::function<void()> last_words)
    : interruption_(interruption) {
    const auto lock = interruption_.postpone();
    interruption_.tick_ = std::move(tick);
    interruption_.last_words_ = std::move(last_words);
}

Interruption::Watch::~Watch() {
    const auto lock = interruption_.postpone();
    interruption_.tick_ = nullptr;
    interruption_.last_words_ = nullptr;
}

void Interruption::wait(const std::stop_token& stop) {
    const sigset_t set = ending_signals();
    const timespec pause{0, 100'000'000};
    while (!stop.stop_requested()) {
        const int signal = sigtimedwait(&set, nullptr, &pause);
        const auto lock = postpone();
        if (signal > 0) {
            try {
                if (last_words_) last_words_();
            } catch (const std::exception& error) {
                print_error(fmt::format("controlspace: error: {}\n", error.what()));
            }
            // The main thread may be inside a long computation, which cannot be cancelled.
            std::_Exit(128 + signal);
        }
        if (tick_) tick_();
    }
}

}  // namespace controlspace
