// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <mutex>
#include <thread>

namespace controlspace {

/// Ends the program on SIGINT (Ctrl-C) or SIGTERM with status 128 + signal, at any time except
/// while files are being written. A thread of its own waits for the signals, so that the functions
/// it calls need not be async-signal-safe. To be constructed before any other thread starts:
/// threads inherit that the signals are blocked.
class Interruption {
public:
    Interruption();
    ~Interruption();
    Interruption(const Interruption&) = delete;
    Interruption& operator=(const Interruption&) = delete;

    /// The program is not ended while the lock is held.
    std::unique_lock<std::mutex> postpone() { return std::unique_lock(mutex_); }

    /// During its lifetime, `tick` is called several times a second, and `last_words` before the
    /// program is ended.
    class Watch {
    public:
        Watch(Interruption& interruption, std::function<void()> tick,
              std::function<void()> last_words);
        ~Watch();
        Watch(const Watch&) = delete;
        Watch& operator=(const Watch&) = delete;

    private:
        Interruption& interruption_;
    };

private:
    void wait(const std::stop_token& stop);

    std::mutex mutex_;
    std::function<void()> tick_;
    std::function<void()> last_words_;
    std::jthread thread_;
};

}  // namespace controlspace
