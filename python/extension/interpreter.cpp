#include "interpreter.hpp"

#include <pthread.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace pliant::python {
namespace {

constexpr auto patience = std::chrono::seconds(10);

std::atomic<int> calls_at_work = 0;  ///< without the interpreter's lock
std::atomic<bool> ends = false;
std::atomic<std::thread::id> ending_thread;

/// All that is at work is cancelled, and waited for. What cannot be cancelled and takes longer goes on until the
/// process ends.
void end_calls() {
    ending_thread = std::this_thread::get_id();
    ends = true;
    const py::gil_scoped_release unlocked;
    const auto until = std::chrono::steady_clock::now() + patience;
    while (calls_at_work > 0 && std::chrono::steady_clock::now() < until)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

}  // namespace

bool python_ends() {
    return ends && ending_thread.load() != std::this_thread::get_id();
}

void wait_for_the_end() {
    for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

Unlocked::Unlocked() : state_(PyEval_SaveThread()) {
    ++calls_at_work;
    if (!python_ends()) return;
    --calls_at_work;
    wait_for_the_end();
}

Unlocked::~Unlocked() {
    --calls_at_work;
    if (python_ends()) wait_for_the_end();
    try {
        PyEval_RestoreThread(state_);
    } catch (...) {
        wait_for_the_end();
    }
}

Locked::Locked() {
    try {
        state_ = PyGILState_Ensure();
    } catch (...) {
        wait_for_the_end();
    }
}

py::object call(const py::object& callable, const py::tuple& arguments) {
    PyObject* result = nullptr;
    try {
        result = PyObject_CallObject(callable.ptr(), arguments.ptr());
    } catch (...) {  // here, so that nothing is unwound that needs the lock
        wait_for_the_end();
    }
    if (result == nullptr) throw py::error_already_set();
    return py::reinterpret_steal<py::object>(result);
}

void add_ending(py::module_&) {
    pthread_atfork(nullptr, nullptr, [] { calls_at_work = 0; });  // a forked process has none of the other threads
    py::module_::import("atexit").attr("register")(py::cpp_function(&end_calls));
}

}  // namespace pliant::python
