// Inputs as Python tuples: (time, kinds, values), cables first.
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>
#include <tuple>
#include <vector>

#include "pliant/linearisation.hpp"
#include "pliant/simulation.hpp"

namespace pliant::python {

namespace py = pybind11;

using InputTuple = std::tuple<double, std::vector<std::string>, std::vector<double>>;

[[nodiscard]] InputTuple tuple_of(const Inputs& inputs);
/// Throws if the numbers of kinds, values and actuators differ, or a kind is unknown.
[[nodiscard]] Inputs inputs_of(const Model& model, const InputTuple& tuple);
[[nodiscard]] py::dict dict_of(const StepResult& result);
[[nodiscard]] py::dict dict_of(const Observation& seen);
/// A tuple (name, unit, value) each.
[[nodiscard]] py::list parameter_list(const std::vector<Parameter>& all);

}  // namespace pliant::python
