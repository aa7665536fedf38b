// Robot, Model and State.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <optional>

#include "arrays.hpp"
#include "interpreter.hpp"
#include "parts.hpp"
#include "pliant/simulation.hpp"
#include "values.hpp"
#include "watcher.hpp"

namespace pliant::python {
namespace {

Model meshed(const Robot& robot, py::object progress, std::optional<double> tolerance,
             std::optional<int> iteration_limit) {
    Watcher watcher(std::move(progress));
    const Watch watch = watcher.watch();
    const Unlocked unlocked;
    return Model(robot, StepOptions{tolerance, iteration_limit}, watch);
}

Model on_mesh(const Robot& robot, const Mesh& mesh, std::optional<double> tolerance,
              std::optional<int> iteration_limit) {
    const Unlocked unlocked;
    return Model(robot, mesh, StepOptions{tolerance, iteration_limit});
}

Mesh mesh_of(const Numbers& points, const Indices& tets, const Indices& regions, std::vector<std::string> names) {
    if (tets.ndim() != 2) throw Failure(Failure::Kind::input, "the mesh: tets must be an array (tets, 4 or 10)");
    Mesh mesh;
    mesh.points = points_of(points);
    mesh.tets.assign(tets.data(), tets.data() + tets.size());
    mesh.nodes_per_tet = static_cast<int>(tets.shape(1));
    mesh.regions.assign(regions.data(), regions.data() + regions.size());
    if (!names.empty()) mesh.region_names = std::move(names);
    return mesh;
}

Shape rows(std::size_t numbers, std::size_t width) {
    return {static_cast<py::ssize_t>(numbers / width), static_cast<py::ssize_t>(width)};
}

py::array positions(const State& state) {
    const std::span<const double> x = state.coordinates();
    return view(x.data(), rows(x.size(), 3), state);
}

}  // namespace

void add_robot(py::module_& module) {
    py::class_<Robot>(module, "Robot")
        .def_static("load", &Robot::load, py::call_guard<Unlocked>())
        .def_static("parse", &Robot::parse, py::call_guard<Unlocked>())
        .def_property_readonly("name", &Robot::name)
        .def_property_readonly("duration", &Robot::duration)
        .def_property_readonly("steps", &Robot::steps)
        .def("text", &Robot::text);
    py::class_<Mesh>(module, "Mesh").def(py::init(&mesh_of));
    py::class_<Model>(module, "Model")
        .def(py::init(&on_mesh))
        .def(py::init(&meshed))
        .def_property_readonly("node_count", &Model::node_count)
        .def_property_readonly("tet_count", &Model::tet_count)
        .def_property_readonly("order", &Model::order)
        .def("rest_positions",
             [](const Model& model) {
                 const std::span<const double> x = model.rest_coordinates();
                 return view(x.data(), rows(x.size(), 3), model);
             })
        .def("tets",
             [](const Model& model) {
                 const std::size_t width = model.order() == 2 ? 10 : 4;
                 return view(model.tets().data(), rows(model.tets().size(), width), model);
             })
        .def("regions",
             [](const Model& model) {
                 return view(model.regions().data(), {static_cast<py::ssize_t>(model.regions().size())}, model);
             })
        .def_property_readonly("region_names", &Model::region_names)
        .def("surface", [](const Model& model) { return array_of(model.surface()); })
        .def_property_readonly("cables", &Model::cables)
        .def_property_readonly("chambers", &Model::chambers)
        .def_property_readonly("markers", &Model::markers)
        .def("warnings", &Model::warnings, py::call_guard<Unlocked>());
    py::class_<State>(module, "State")
        .def(py::init<const State&>())
        .def("positions", &positions)
        .def("velocities", [](const State& state) { return array_of(state.velocities()); })
        .def("inputs", [](const State& state) { return tuple_of(state.inputs()); })
        .def("bytes", [](const State& state) { return py::bytes(state.bytes()); })
        // Of copies: another thread may step the caller's states meanwhile.
        .def("save",
             [](const State& state, const std::filesystem::path& file) {
                 const State same = state;
                 const Unlocked unlocked;
                 same.save(file);
             })
        .def("equals", [](const State& a, const State& b) {
            const State one = a, other = b;
            const Unlocked unlocked;
            return one == other;
        });
}

}  // namespace pliant::python
