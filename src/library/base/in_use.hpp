// Objects that work on one thing at a time: a second use at the same time is an error instead of nonsense.
#pragma once

#include <fmt/format.h>

#include <atomic>

#include "pliant/base.hpp"

namespace pliant::library {

/// Whether an object is at work.
class InUse {
public:
    explicit InUse(const char* what) : what_(what) {}

private:
    friend class Use;
    const char* what_;
    std::atomic<bool> busy_ = false;
};

/// Held for as long as a member works. Throws if another one does: on another thread, or below, from a Watch.
class Use {
public:
    explicit Use(InUse& object) : object_(object) {
        if (!object.busy_.exchange(true, std::memory_order_acquire)) return;
        throw Failure(
            Failure::Kind::input,
            fmt::format("the {} is at work, on another thread or in the call whose Watch uses it; take one for "
                        "each thread, and another one in the Watch",
                        object.what_));
    }
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;
    ~Use() { object_.busy_.store(false, std::memory_order_release); }

private:
    InUse& object_;
};

}  // namespace pliant::library
