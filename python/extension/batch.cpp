// Many robots at once.
#include "pliant/batch.hpp"

#include <pybind11/stl.h>

#include "arrays.hpp"
#include "interpreter.hpp"
#include "parts.hpp"
#include "pliant/linearisation.hpp"
#include "turns.hpp"
#include "values.hpp"
#include "watcher.hpp"

namespace pliant::python {
namespace {

struct Many {
    Many(const std::vector<Model>& all, const StepOptions& options, int threads, const Watch& watch)
        : models(all), batch(all, options, threads, watch) {}
    std::vector<Model> models;
    Batch batch;
    Turns turns{"batch"};
};

/// A Python None is passed as a null pointer.
template <class T>
const T& there(const T* thing) {
    if (thing == nullptr) throw Failure(Failure::Kind::input, "one of the robots is None");
    return *thing;
}

std::vector<State> states_of(const std::vector<State*>& states) {
    std::vector<State> copies;
    for (const State* state : states) copies.push_back(there(state));
    return copies;
}

std::vector<StepResult> step_all(Many& many, const std::vector<State*>& states, const std::vector<Inputs>& inputs,
                                 py::object progress) {
    Watcher watcher(std::move(progress));
    const Watch watch = watcher.watch();
    std::vector<State> next = states_of(states);
    std::vector<StepResult> results;
    const std::exception_ptr thrown = many.turns.take([&]() -> std::exception_ptr {
        try {
            results = many.batch.step(next, inputs, watch);
        } catch (...) {
            return std::current_exception();
        }
        return {};
    });
    for (std::size_t i = 0; i < states.size(); ++i) *states[i] = next[i];
    if (thrown) std::rethrow_exception(thrown);
    return results;
}

std::vector<StepResult> step_all_to(Many& many, const std::vector<State*>& states,
                                    const std::vector<InputTuple>& inputs, py::object progress) {
    if (inputs.size() != many.models.size())
        throw Failure(Failure::Kind::input,
                      std::to_string(inputs.size()) + " inputs for " + std::to_string(many.models.size()) + " robots");
    std::vector<Inputs> wanted;
    for (std::size_t i = 0; i < inputs.size(); ++i) wanted.push_back(inputs_of(many.models[i], inputs[i]));
    return step_all(many, states, wanted, std::move(progress));
}

py::list observe(Many& many, const std::vector<State*>& states) {
    const std::vector<State> copies = states_of(states);
    const std::vector<Observation> seen = many.turns.take([&] { return many.batch.observe(copies); });
    py::list list;
    for (const Observation& one : seen) list.append(dict_of(one));
    return list;
}

}  // namespace

void add_batch(py::module_& module) {
    py::class_<Many>(module, "Batch")
        .def(py::init([](const std::vector<const Model*>& models, std::optional<double> tolerance,
                         std::optional<int> iteration_limit, int threads) {
            std::vector<Model> all;
            for (const Model* model : models) all.push_back(there(model));
            Watcher watcher{py::none()};
            const Watch watch = watcher.watch();
            const Unlocked unlocked;
            return std::make_unique<Many>(all, StepOptions{tolerance, iteration_limit}, threads, watch);
        }))
        .def_property_readonly("size", [](const Many& many) { return many.batch.size(); })
        .def_property_readonly("threads", [](const Many& many) { return many.batch.threads(); })
        .def("rest", [](const Many& many) { return many.batch.rest(); })
        .def("step", &step_all_to)
        .def("observe", &observe);
}

}  // namespace pliant::python
