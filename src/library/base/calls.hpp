// Connects the library to its users: errors become exceptions, a Watch becomes a Progress.
#pragma once

#include <atomic>
#include <exception>
#include <string>
#include <thread>
#include <utility>

#include "base/core/error.hpp"
#include "base/core/progress.hpp"
#include "pliant/base.hpp"

namespace pliant::library {

[[noreturn]] void fail(const Error& error);

template <class T>
[[nodiscard]] T value_of(Result<T> result) {
    if (!result) fail(result.error());
    return std::move(*result);
}
inline void check(const Status& status) {
    if (!status) fail(status.error());
}

/// An exception from the Watch cancels the work, and is thrown again by rethrow().
class WatchedProgress final : public Progress {
public:
    /// `watch` must outlive it. `stage`: that of the work until it tells its own.
    WatchedProgress(const Watch& watch, std::string stage) : watch_(watch), stage_(std::move(stage)) {}
    void advance(std::string_view stage, double fraction) override;
    /// Calls the Watch again, but only on its own thread.
    [[nodiscard]] bool cancelled() const override;
    void rethrow() const;

private:
    void ask() const;

    const Watch& watch_;
    std::thread::id thread_ = std::this_thread::get_id();
    std::string stage_;
    double share_ = 0;
    mutable std::atomic<bool> cancelled_ = false;
    mutable std::exception_ptr thrown_;
};

}  // namespace pliant::library
