// Steps from one state to the next, and observations of a state.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <optional>
#include <sstream>
#include <tuple>

#include "arrays.hpp"
#include "engine.hpp"
#include "interpreter.hpp"
#include "parts.hpp"
#include "values.hpp"
#include "watcher.hpp"

namespace pliant::python {
namespace {

/// The caller's state is replaced as a whole while the interpreter's lock is held: other threads may read it meanwhile.
StepResult step(Engine& engine, State& state, const Inputs& inputs, py::object progress) {
    Watcher watcher(std::move(progress));
    const Watch watch = watcher.watch();
    State next = state;
    StepResult result;
    std::exception_ptr thrown;
    {
        const Unlocked unlocked;
        try {
            result = engine.with([&](Stepper& stepper) { return stepper.step(next, inputs, watch); });
        } catch (...) {
            thrown = std::current_exception();
        }
    }
    state = next;
    if (thrown) std::rethrow_exception(thrown);
    return result;
}

StepResult step_to(Engine& engine, State& state, const InputTuple& inputs, py::object progress) {
    return step(engine, state, inputs_of(engine.model(), inputs), std::move(progress));
}

/// The drives of the state with other values.
StepResult step_values(Engine& engine, State& state, const Numbers& values, std::optional<double> time,
                       py::object progress) {
    Inputs inputs = state.inputs();
    const std::size_t cables = inputs.cables.size(), all = cables + inputs.chambers.size();
    if (static_cast<std::size_t>(values.size()) != all)
        throw Failure(Failure::Kind::input,
                      std::to_string(values.size()) + " controls for " + std::to_string(all) + " cables and chambers");
    for (std::size_t a = 0; a < all; ++a)
        (a < cables ? inputs.cables[a] : inputs.chambers[a - cables]).value = values.data()[a];
    if (time) inputs.time = *time;
    return step(engine, state, inputs, std::move(progress));
}

template <class Result>
Result unlocked(Engine& engine, Result (*use)(Stepper&, const State&), const State& state) {
    const State same = state;
    const Unlocked unlocked;
    return engine.with([&](Stepper& stepper) { return use(stepper, same); });
}

py::dict fields(Engine& engine, const State& state) {
    using namespace py::literals;
    Fields f = unlocked<Fields>(
        engine, [](Stepper& stepper, const State& s) { return stepper.fields(s); }, state);
    return py::dict("volume_ratio"_a = array_of(std::move(f.volume_ratio)),
                    "von_mises_Pa"_a = array_of(std::move(f.von_mises_Pa)),
                    "max_stretch"_a = array_of(std::move(f.max_stretch)),
                    "energy_density_Pa"_a = array_of(std::move(f.energy_density_Pa)));
}

py::list cable_paths(Engine& engine, const State& state) {
    auto paths = unlocked<std::vector<std::vector<Point>>>(
        engine, [](Stepper& stepper, const State& s) { return stepper.cable_paths(s); }, state);
    py::list all;
    for (auto& path : paths) all.append(array_of(std::move(path)));
    return all;
}

using StepTuple = std::tuple<bool, bool, std::string, int, int, double>;

StepTuple tuple_of(const StepResult& r) {
    return {r.arrived, r.loose, r.reason, r.iterations, r.pieces, r.residual};
}
StepResult step_result_of(const StepTuple& tuple) {
    const auto& [arrived, loose, reason, iterations, pieces, residual] = tuple;
    return {arrived, loose, reason, iterations, pieces, residual};
}

std::string repr_of(const StepResult& r) {
    std::ostringstream text;
    text.precision(2);
    text << "<pliant.StepResult: " << (r.arrived ? "arrived" : "not arrived") << (r.loose ? ", loose" : "") << ", "
         << r.iterations << " iterations, " << r.pieces << " pieces, residual " << r.residual;
    if (!r.reason.empty()) text << ": " << r.reason;
    return text.str() + ">";
}

void add_step_result(py::module_& module) {
    py::class_<StepResult>(module, "StepResult", "Result of a step.")
        .def_readonly("arrived", &StepResult::arrived,
                      "True if the state has the requested inputs; otherwise it is as far as the solver got.")
        .def_readonly("loose", &StepResult::loose,
                      "True if the step was accepted at a looser tolerance, because friction did not settle.")
        .def_readonly("reason", &StepResult::reason,
                      "Why it did not arrive, or at which tolerance it was accepted; otherwise empty.")
        .def_readonly("iterations", &StepResult::iterations, "Number of solver iterations.")
        .def_readonly("pieces", &StepResult::pieces, "Number of substeps that the step was divided into.")
        .def_readonly("residual", &StepResult::residual,
                      "Norm of the out-of-balance force over the norm of the forces that balance; no unit.")
        .def("__eq__",
             [](const StepResult& a, const py::object& b) {
                 return py::isinstance<StepResult>(b) && tuple_of(a) == tuple_of(b.cast<const StepResult&>());
             })
        .def("__repr__", &repr_of)
        .def("__copy__", [](const StepResult& result) { return result; })
        .def("__deepcopy__", [](const StepResult& result, const py::dict&) { return result; })
        .def(py::pickle([](const StepResult& result) { return tuple_of(result); }, &step_result_of));
}

}  // namespace

void add_steps(py::module_& module) {
    add_step_result(module);
    py::class_<Engine>(module, "Engine")
        .def(py::init<const Model&>(), py::call_guard<Unlocked>())
        .def("rest", [](Engine& engine) { return engine.with([](Stepper& stepper) { return stepper.rest(); }); })
        .def("program",
             [](Engine& engine, double time) {
                 return tuple_of(engine.with([&](Stepper& stepper) { return stepper.program(time); }));
             })
        .def("step", &step_to)
        .def("step_values", &step_values)
        .def("observe",
             [](Engine& engine, const State& state) {
                 return dict_of(unlocked<Observation>(
                     engine, [](Stepper& stepper, const State& s) { return stepper.observe(s); }, state));
             })
        .def("fields", &fields)
        .def("contact_forces",
             [](Engine& engine, const State& state) {
                 return array_of(unlocked<std::vector<Point>>(
                     engine, [](Stepper& stepper, const State& s) { return stepper.contact_forces(s); }, state));
             })
        .def("cable_paths", &cable_paths)
        .def("state_from",
             [](Engine& engine, const py::bytes& bytes) {
                 const std::string text = bytes;
                 const Unlocked unlocked;
                 return engine.with([&](Stepper& stepper) { return stepper.state_from(text); });
             })
        .def("load", [](Engine& engine, const std::filesystem::path& file) {
            const Unlocked unlocked;
            return engine.with([&](Stepper& stepper) { return stepper.load(file); });
        });
}

}  // namespace pliant::python
