// The parts of the low-level module pliant._pliant. Users import the package python/pliant, which documents shapes and
// units and checks its arguments.
#pragma once

#include <pybind11/pybind11.h>

#include "pliant/base.hpp"

namespace pliant::python {

namespace py = pybind11;

void add_failures(py::module_& module);
void add_robot(py::module_& module);
void add_steps(py::module_& module);
void add_linearisation(py::module_& module);
void add_program(py::module_& module);
void add_printing(py::module_& module);
void add_batch(py::module_& module);
void add_inverse(py::module_& module);
void add_reduced(py::module_& module);
void add_view(py::module_& module);

}  // namespace pliant::python
