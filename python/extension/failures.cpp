// Converts a Failure of the library to the exception of pliant.errors for its kind.
#include <string>

#include "parts.hpp"

namespace pliant::python {
namespace {

/// A class of pliant.errors, or a function that chooses one.
const char* maker_of(Failure::Kind kind) {
    switch (kind) {
        case Failure::Kind::input:
            return "input_error";
        case Failure::Kind::cancelled:
            return "Cancelled";
        case Failure::Kind::failed:
            break;
    }
    return "Failure";
}

/// Paths may have bytes that are not UTF-8.
py::object decoded(const std::string& bytes) {
    return py::reinterpret_steal<py::object>(
        PyUnicode_DecodeUTF8(bytes.data(), static_cast<py::ssize_t>(bytes.size()), "replace"));
}

void raise(const Failure& failure) {
    try {
        const py::object make = py::module_::import("pliant.errors").attr(maker_of(failure.kind()));
        const py::object error =
            make(decoded(failure.what()), decoded(failure.file()), failure.line(), decoded(failure.key()));
        PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(error.ptr())), error.ptr());
    } catch (py::error_already_set& error) {
        error.restore();
    }
}

}  // namespace

void add_failures(py::module_&) {
    py::register_exception_translator([](std::exception_ptr thrown) {
        try {
            if (thrown) std::rethrow_exception(thrown);
        } catch (const Failure& failure) {
            raise(failure);
        }
    });
}

}  // namespace pliant::python
