// Work on one thing that threads of Python take turns at.
#pragma once

#include <atomic>
#include <chrono>
#include <mutex>
#include <string>
#include <thread>

#include "interpreter.hpp"
#include "pliant/base.hpp"

namespace pliant::python {

class Turns {
public:
    /// `what`: the thing, for the error.
    explicit Turns(const char* what) : what_(what) {}

    /// Calls `use` without the interpreter's lock, after the threads that are at it. Ctrl-C ends the wait. Throws if it
    /// is called from within: from a progress callable.
    template <class Use>
    auto take(const Use& use) {
        if (owner_ == std::this_thread::get_id())
            throw Failure(Failure::Kind::input,
                          std::string("the ") + what_ + " is at work: its progress cannot use it");
        const Unlocked unlocked;
        wait();
        const std::lock_guard lock(mutex_, std::adopt_lock);
        owner_ = std::this_thread::get_id();
        const Leave leave{owner_};
        return use();
    }

private:
    struct Leave {
        ~Leave() { owner = std::thread::id(); }
        std::atomic<std::thread::id>& owner;
    };

    void wait() {
        constexpr auto interval = std::chrono::milliseconds(50);
        while (!mutex_.try_lock_for(interval)) {
            if (python_ends()) throw Failure(Failure::Kind::cancelled, "cancelled");
            const Locked locked;
            if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        }
    }

    const char* what_;
    std::timed_mutex mutex_;
    std::atomic<std::thread::id> owner_;
};

}  // namespace pliant::python
