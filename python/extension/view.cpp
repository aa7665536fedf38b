// Data for the viewer in a notebook.
#include "pliant/view.hpp"

#include "arrays.hpp"
#include "interpreter.hpp"
#include "parts.hpp"

namespace pliant::python {

void add_view(py::module_& module) {
    py::class_<View>(module, "View")
        .def(py::init<const Model&>(), py::call_guard<Unlocked>())
        .def("scene", [](const View& view) { return py::bytes(view.scene()); })
        .def("frame", [](const View& view, const State& state) { return py::bytes(view.frame(state)); })
        .def("frame_of", [](const View& view, const Numbers& positions, double time) {
            return py::bytes(view.frame(points_of(positions), time));
        });
}

}  // namespace pliant::python
