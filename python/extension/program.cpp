// Whole programs and their results folder.
#include "pliant/program.hpp"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <optional>

#include "arrays.hpp"
#include "interpreter.hpp"
#include "parts.hpp"
#include "values.hpp"
#include "watcher.hpp"

namespace pliant::python {
namespace {

py::tuple tuple_of_step(ProgramStep step) {
    return py::make_tuple(step.index, step.time, step.result, dict_of(step.observed),
                          array_of(std::move(step.positions)));
}

/// If a Python callable throws, the run ends as if it had been cancelled.
ProgramResult run_program(const Model& model, py::object on_step, const std::filesystem::path& measured,
                          const std::filesystem::path& checkpoint, int checkpoint_every, bool resume,
                          py::object progress) {
    Watcher watcher(std::move(progress));
    RunOptions options;
    if (!on_step.is_none()) {
        options.on_step = [&](const ProgramStep& step) {
            const Locked locked;
            try {
                (void)call(on_step, py::make_tuple(tuple_of_step(step)));
            } catch (const py::error_already_set& error) {
                watcher.remember(error);
            }
        };
    }
    options.measured = measured;
    options.checkpoint = checkpoint;
    options.checkpoint_every = checkpoint_every;
    options.resume = resume;
    const Watch watch = watcher.watch();
    std::optional<ProgramResult> result;
    {
        const Unlocked unlocked;
        result.emplace(run(model, options, watch));
    }
    watcher.rethrow();
    return *result;
}

Pictures pictures_of(const std::string& name) {
    if (name == "none") return Pictures::none;
    if (name == "few") return Pictures::few;
    if (name == "all") return Pictures::all;
    throw Failure(Failure::Kind::input, "pictures are \"none\", \"few\" or \"all\", not \"" + name + "\"");
}

bool write(ProgramResult& result, const std::filesystem::path& folder, const std::string& pictures,
           std::array<int, 2> size_px, bool film, std::optional<Point> towards_eye, py::object progress) {
    ResultsOptions options;
    options.pictures = pictures_of(pictures);
    options.picture_size_px = size_px;
    options.film = film;
    options.towards_eye = towards_eye;
    Watcher watcher(std::move(progress));
    const Watch watch = watcher.watch();
    const Unlocked unlocked;
    return result.write(folder, options, watch);
}

}  // namespace

void add_program(py::module_& module) {
    py::class_<ProgramResult>(module, "ProgramResult")
        .def_property_readonly("converged", &ProgramResult::converged)
        .def_property_readonly("message", &ProgramResult::message)
        .def_property_readonly("warnings", &ProgramResult::warnings)
        .def_property_readonly("solver", &ProgramResult::solver)
        .def_property_readonly("solve_s", &ProgramResult::solve_s)
        .def_property_readonly("step_count", &ProgramResult::step_count)
        .def("step", [](const ProgramResult& result, std::size_t index) { return tuple_of_step(result.step(index)); })
        .def("positions",
             [](const ProgramResult& result, std::size_t index) { return array_of(result.step(index).positions); })
        .def("deviations", &ProgramResult::deviations)
        .def("summary_json", &ProgramResult::summary_json)
        .def("write", &write)
        .def("remove_checkpoint", &ProgramResult::remove_checkpoint);
    module.def("run", &run_program);
}

}  // namespace pliant::python
