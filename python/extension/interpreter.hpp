// The interpreter's lock, and the end of the interpreter while threads are at work.
//
// When Python ends, a thread that asks for the interpreter's lock is ended (before Python 3.14): its stack is unwound
// as if by an exception, which C++ does not survive. Daemon threads, which Python does not wait for, are therefore
// asked to leave the library before Python ends, and wait here for the end of the process.
#pragma once

#include <pybind11/pybind11.h>

namespace pliant::python {

namespace py = pybind11;

/// True once Python is about to end, except on the thread that ends it: work is to stop.
[[nodiscard]] bool python_ends();

/// Never returns: for a thread that Python would end.
[[noreturn]] void wait_for_the_end();

/// Without the interpreter's lock.
class Unlocked {
public:
    Unlocked();
    /// Does not return on a thread that Python would end.
    ~Unlocked();
    Unlocked(const Unlocked&) = delete;
    Unlocked& operator=(const Unlocked&) = delete;

private:
    PyThreadState* state_;
};

/// With the interpreter's lock.
class Locked {
public:
    Locked();
    ~Locked() { PyGILState_Release(state_); }
    Locked(const Locked&) = delete;
    Locked& operator=(const Locked&) = delete;

private:
    PyGILState_STATE state_;
};

/// Calls a Python callable, with the interpreter's lock held. Does not return on a thread that Python ends meanwhile.
[[nodiscard]] py::object call(const py::object& callable, const py::tuple& arguments);

/// Ends the work of all threads before Python ends.
void add_ending(py::module_& module);

}  // namespace pliant::python
