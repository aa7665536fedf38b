// A Watch for work that Python waits for: Ctrl-C cancels it, and a callable receives its progress.
#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <optional>
#include <string_view>

#include "pliant/base.hpp"

namespace pliant::python {

namespace py = pybind11;

/// Created and destroyed while the interpreter's lock is held; the work itself is done without it.
class Watcher {
public:
    /// `progress`: None, or called with (stage, share); if it returns False the work is cancelled.
    explicit Watcher(py::object progress);
    Watcher(const Watcher&) = delete;
    Watcher& operator=(const Watcher&) = delete;

    /// Valid as long as this object exists.
    [[nodiscard]] Watch watch();
    /// Stores an exception of a user callable that must not propagate: it is thrown again by the watch, or by
    /// rethrow().
    void remember(const py::error_already_set& error) { thrown_ = error; }
    void rethrow() const {
        if (thrown_) throw *thrown_;
    }

private:
    using Clock = std::chrono::steady_clock;
    bool ask(std::string_view stage, double share);

    py::object progress_;
    Clock::time_point next_;
    std::optional<py::error_already_set> thrown_;
};

}  // namespace pliant::python
