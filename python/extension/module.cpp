#include "interpreter.hpp"
#include "parts.hpp"

PYBIND11_MODULE(_pliant, module) {
    using namespace pliant::python;
    module.doc() = "What the module pliant is made with; use that.";
    add_ending(module);
    add_failures(module);
    add_robot(module);
    add_steps(module);
    add_linearisation(module);
    add_program(module);
    add_printing(module);
    add_batch(module);
    add_inverse(module);
    add_reduced(module);
    add_view(module);
    module.def("version", [] { return std::string(pliant::version()); });
    module.def("quantity", &pliant::quantity, py::arg("text"), py::arg("unit"));
}
