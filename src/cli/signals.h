#pragma once

#include <functional>
#include <mutex>
#include <thread>

namespace controlspace {

/// Ends the program at SIGINT (Ctrl-C) or SIGTERM with status 128 + signal, whatever it computes at
/// that time, but not while something is being written. A thread of its own waits for the signals,
/// so what it calls may do anything. Made before any other thread, which inherit that signals are
/// left to this one.
class Interruption {
public:
    Interruption();
    ~Interruption();
    Interruption(const Interruption&) = delete;
    Interruption& operator=(const Interruption&) = delete;

    /// While the lock is held, the program is not ended.
    std::unique_lock<std::mutex> postpone() { return std::unique_lock(mutex_); }

    /// As long as it lives, `tick` is called several times a second, and `last_words` before the
    /// end.
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
