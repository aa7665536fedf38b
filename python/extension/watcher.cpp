#include "watcher.hpp"

#include <string>
#include <utility>

#include "interpreter.hpp"

namespace pliant::python {
namespace {

constexpr auto interval = std::chrono::milliseconds(50);

/// False, or numpy's; anything else goes on.
bool is_false(const py::object& answer) {
    py::detail::make_caster<bool> truth;
    return truth.load(answer, false) && !static_cast<bool>(truth);
}

}  // namespace

/// Short work never calls the callable; it is told the beginning of longer work.
Watcher::Watcher(py::object progress)
    : progress_(std::move(progress)), next_(progress_.is_none() ? Clock::now() + interval : Clock::now()) {}

Watch Watcher::watch() {
    return [this](std::string_view stage, double share) { return ask(stage, share); };
}

bool Watcher::ask(std::string_view stage, double share) {
    const Clock::time_point now = Clock::now();
    if (now < next_ && !thrown_) return true;
    next_ = now + interval;
    if (python_ends()) return false;
    const Locked locked;
    rethrow();
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (progress_.is_none()) return true;
    return !is_false(call(progress_, py::make_tuple(std::string(stage), share)));
}

}  // namespace pliant::python
