// Reduced-order models.
#include "pliant/reduced.hpp"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <memory>

#include "arrays.hpp"
#include "interpreter.hpp"
#include "parts.hpp"
#include "turns.hpp"
#include "values.hpp"
#include "watcher.hpp"

namespace pliant::python {
namespace {

/// A reduced model with its solver, which one thread at a time uses.
class ReducedEngine {
public:
    explicit ReducedEngine(ReducedModel model) : model_(std::move(model)), stepper_(model_) {}
    [[nodiscard]] const ReducedModel& model() const { return model_; }
    /// Without the interpreter's lock.
    template <class Use>
    auto with(const Use& use) {
        return turns_.take([&] { return use(stepper_); });
    }

private:
    ReducedModel model_;
    ReducedStepper stepper_;
    Turns turns_{"reduced model"};
};

std::unique_ptr<ReducedEngine> reduce_model(const Model& model, int samples, double basis_error, double force_error,
                                            int most_modes, py::object progress) {
    Watcher watcher(std::move(progress));
    const Watch watch = watcher.watch();
    const Unlocked unlocked;
    return std::make_unique<ReducedEngine>(reduce(model, {samples, basis_error, force_error, most_modes}, watch));
}

py::tuple step_reduced(ReducedEngine& engine, const ReducedState& state, const InputTuple& inputs) {
    const Inputs wanted = inputs_of(engine.model().whole(), inputs);
    ReducedState next = state;
    const ReducedStep done = engine.with([&](ReducedStepper& stepper) { return stepper.step(next, wanted); });
    return py::make_tuple(std::move(next), done.found, done.iterations);
}

py::tuple estimate(ReducedEngine& engine, const ReducedState& state) {
    const ReducedState same = state;
    ReducedError error = engine.with([&](ReducedStepper& stepper) { return stepper.estimate(same); });
    return py::make_tuple(error.error_m, array_of(std::move(error.markers_m)), array_of(std::move(error.tensions_N)),
                          array_of(std::move(error.pressures_Pa)));
}

State exact(ReducedEngine& engine, const ReducedState& state, py::object progress) {
    Watcher watcher(std::move(progress));
    const Watch watch = watcher.watch();
    const ReducedState same = state;
    return engine.with([&](ReducedStepper& stepper) { return stepper.exact(same, watch); });
}

py::list check(const ReducedEngine& engine, int count, py::object progress) {
    Watcher watcher(std::move(progress));
    const Watch watch = watcher.watch();
    std::vector<ReductionCheck> checks;
    {
        const Unlocked unlocked;
        checks = check_reduction(engine.model(), count, watch);
    }
    py::list list;
    for (ReductionCheck& one : checks)
        list.append(py::make_tuple(array_of(std::move(one.inputs)), one.found, one.touching, one.motion_m, one.error_m,
                                   one.estimated_m, one.force_error, one.reduced_s, one.estimate_s, one.whole_s));
    return list;
}

}  // namespace

void add_reduced(py::module_& module) {
    py::class_<ReducedState>(module, "ReducedState")
        .def("inputs", [](const ReducedState& state) { return tuple_of(state.inputs()); })
        .def("amplitudes", [](const ReducedState& state) { return array_of(state.amplitudes()); })
        .def("markers", [](const ReducedState& state) { return array_of(state.markers()); })
        .def("tensions", [](const ReducedState& state) { return array_of(state.tensions_N()); })
        .def("pressures", [](const ReducedState& state) { return array_of(state.pressures_Pa()); })
        .def("positions", [](const ReducedState& state) { return array_of(state.positions()); });
    py::class_<ReducedEngine>(module, "ReducedEngine")
        .def_property_readonly("mode_count", [](const ReducedEngine& engine) { return engine.model().mode_count(); })
        .def_property_readonly("tet_count", [](const ReducedEngine& engine) { return engine.model().tet_count(); })
        .def_property_readonly("sample_count",
                               [](const ReducedEngine& engine) { return engine.model().sample_count(); })
        .def_property_readonly("force_error", [](const ReducedEngine& engine) { return engine.model().force_error(); })
        .def_property_readonly("notes", [](const ReducedEngine& engine) { return engine.model().notes(); })
        .def("inputs",
             [](const ReducedEngine& engine) {
                 py::list list;
                 for (const SteeredInput& input : engine.model().inputs())
                     list.append(py::make_tuple(input.name, input.unit, input.low, input.high));
                 return list;
             })
        .def("start",
             [](ReducedEngine& engine) { return engine.with([](ReducedStepper& stepper) { return stepper.start(); }); })
        .def("step", &step_reduced)
        .def("estimate", &estimate)
        .def("exact", &exact)
        .def("check", &check)
        .def("save", [](const ReducedEngine& engine, const std::filesystem::path& file) {
            const Unlocked unlocked;
            engine.model().save(file);
        });
    module.def("reduce", &reduce_model);
    module.def("load_reduced", [](const Model& model, const std::filesystem::path& file) {
        const Unlocked unlocked;
        return std::make_unique<ReducedEngine>(ReducedModel::load(model, file));
    });
}

}  // namespace pliant::python
