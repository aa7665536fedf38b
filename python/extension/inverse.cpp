// Inverse kinematics, workspaces, identification, gradients of programs.
#include "pliant/inverse.hpp"

#include <pybind11/functional.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <optional>

#include "arrays.hpp"
#include "interpreter.hpp"
#include "measures.hpp"
#include "parts.hpp"
#include "pliant/gradient.hpp"
#include "pliant/identify.hpp"
#include "pliant/workspace.hpp"
#include "values.hpp"
#include "watcher.hpp"

namespace pliant::python {
namespace {

/// Runs `make`, which takes long, with a Watch and without the interpreter's lock.
template <class Make>
auto watched(py::object progress, const Make& make) {
    Watcher watcher(std::move(progress));
    const Watch watch = watcher.watch();
    const Unlocked unlocked;
    return make(watch);
}

py::list steered_list(const std::vector<SteeredInput>& inputs) {
    py::list list;
    for (const SteeredInput& input : inputs) list.append(py::make_tuple(input.name, input.unit, input.low, input.high));
    return list;
}

py::tuple waypoint_tuple(Waypoint w) {
    py::list goals;
    for (GoalResult& goal : w.goals)
        goals.append(py::make_tuple(goal.name, goal.reached, goal.error, goal.unit, array_of(std::move(goal.wanted)),
                                    array_of(std::move(goal.got))));
    return py::make_tuple(w.reached, w.time, goals, w.inputs, w.limits, w.result, dict_of(w.observed),
                          array_of(std::move(w.positions)), w.forward_solutions, w.wall_s);
}

py::tuple sample_tuple(WorkspaceSample s) {
    return py::make_tuple(s.piece, array_of(std::move(s.inputs)), s.found, array_of(std::move(s.markers)),
                          array_of(std::move(s.tensions_N)), array_of(std::move(s.pressures_Pa)));
}

void add_inverse_result(py::module_& module) {
    py::class_<InverseResult>(module, "InverseResult")
        .def_property_readonly("reached", &InverseResult::reached)
        .def_property_readonly("message", &InverseResult::message)
        .def_property_readonly("notes", &InverseResult::notes)
        .def("inputs", [](const InverseResult& result) { return steered_list(result.inputs()); })
        .def_property_readonly("waypoints_wanted", &InverseResult::waypoints_wanted)
        .def_property_readonly("waypoint_count", &InverseResult::waypoint_count)
        .def("waypoint", [](const InverseResult& result, std::size_t k) { return waypoint_tuple(result.waypoint(k)); })
        .def("inputs_at", [](const InverseResult& result, std::size_t k) { return tuple_of(result.inputs_at(k)); })
        .def("text", &InverseResult::text)
        .def("json", [](const InverseResult& result) { return result.json(); })
        .def("write", [](const InverseResult& result, const std::filesystem::path& folder, py::object progress) {
            return watched(std::move(progress), [&](const Watch& watch) { return result.write(folder, watch); });
        });
    module.def("inverse", [](const Model& model, int starts, py::object progress) {
        return watched(std::move(progress), [&](const Watch& watch) { return inverse(model, {starts}, watch); });
    });
}

void add_workspace(py::module_& module) {
    py::class_<Workspace>(module, "Workspace")
        .def("inputs", [](const Workspace& space) { return steered_list(space.inputs()); })
        .def_property_readonly("message", &Workspace::message)
        .def_property_readonly("warnings", &Workspace::warnings)
        .def_property_readonly("sample_count", &Workspace::sample_count)
        .def("sample", [](const Workspace& space, std::size_t k) { return sample_tuple(space.sample(k)); })
        .def("inputs_at", [](const Workspace& space, std::size_t k) { return tuple_of(space.inputs_at(k)); })
        .def("sheets",
             [](const Workspace& space, std::size_t marker) {
                 Surface sheets = space.sheets(marker);
                 return py::make_tuple(array_of(std::move(sheets.points)), array_of(std::move(sheets.triangles)));
             })
        .def("json", &Workspace::json)
        .def("write",
             [](const Workspace& space, const std::filesystem::path& folder, py::object progress) {
                 watched(std::move(progress), [&](const Watch& watch) { space.write(folder, watch); });
             })
        .def("remove_checkpoint", &Workspace::remove_checkpoint);
    module.def("workspace", [](const Model& model, int side, int between, const std::filesystem::path& checkpoint,
                               bool resume, py::object progress) {
        return watched(std::move(progress), [&](const Watch& watch) {
            return workspace(model, {side, between, checkpoint, resume}, watch);
        });
    });
}

JudgeOn judge_of(const std::string& name) {
    if (name == "nothing") return JudgeOn::nothing;
    if (name == "every_second") return JudgeOn::every_second;
    if (name == "second_half") return JudgeOn::second_half;
    throw Failure(Failure::Kind::input,
                  "judge is \"nothing\", \"every_second\" or \"second_half\", not \"" + name + "\"");
}

py::list error_list(const std::vector<FitError>& errors) {
    py::list list;
    for (const FitError& e : errors) list.append(py::make_tuple(e.unit, e.values, e.before, e.after));
    return list;
}

void add_identification(py::module_& module) {
    py::class_<Identification>(module, "Identification")
        .def_property_readonly("converged", &Identification::converged)
        .def("estimates",
             [](const Identification& found) {
                 py::list list;
                 for (const Estimate& e : found.estimates())
                     list.append(py::make_tuple(e.key, e.unit, e.start, e.value, e.low, e.high, e.at_bound, e.matters));
                 return list;
             })
        .def("correlation", &Identification::correlation)
        .def("comparisons",
             [](const Identification& found) {
                 py::list list;
                 for (const Comparison& c : found.comparisons())
                     list.append(
                         py::make_tuple(c.line, c.time, c.quantity, c.unit, c.judged, c.measured, c.before, c.after));
                 return list;
             })
        .def("fitted", [](const Identification& found) { return error_list(found.fitted()); })
        .def("judged", [](const Identification& found) { return error_list(found.judged()); })
        .def_property_readonly("warnings", &Identification::warnings)
        .def_property_readonly("trials", &Identification::trials)
        .def("changes", &Identification::changes)
        .def("text", &Identification::text)
        .def("json", &Identification::json)
        .def("write", &Identification::write, py::call_guard<Unlocked>());
    module.def("identify", [](const Robot& robot, const std::vector<std::string>& unknowns, const std::string& csv,
                              const std::string& file, const std::string& judge, const std::optional<Mesh>& mesh,
                              py::object progress) {
        const JudgeOn judged = judge_of(judge);
        return watched(std::move(progress), [&](const Watch& watch) {
            return identify(robot, unknowns, {csv, file}, judged, mesh, watch);
        });
    });
}

/// Calls a Python callable with the measured numbers of a step: returns a number and its slopes.
class Judge {
public:
    Judge(py::object judge, Watcher& watcher) : judge_(std::move(judge)), watcher_(watcher) {}

    Judgement operator()(int step, std::span<const double> values) const {
        const Locked locked;
        try {
            const py::array_t<double> numbers(static_cast<py::ssize_t>(values.size()), values.data());
            const py::object judged = call(judge_, py::make_tuple(step, numbers));
            const auto [value, slopes] = judged.cast<std::pair<double, std::vector<double>>>();
            return {value, slopes};
        } catch (const py::error_already_set& error) {
            watcher_.remember(error);
            throw Failure(Failure::Kind::cancelled, "the objective failed");
        }
    }

private:
    py::object judge_;
    Watcher& watcher_;
};

py::dict gradient_dict(ProgramGradient g) {
    using namespace py::literals;
    py::list tets, instants, guides;
    for (GuidePoint& p : g.guide_points) guides.append(py::make_tuple(std::move(p.name), p.place));
    for (TetGradient& t : g.by_tets) tets.append(py::make_tuple(t.name, t.unit, array_of(std::move(t.values))));
    for (auto& i : g.instants) instants.append(py::make_tuple(i.step, i.time, array_of(std::move(i.by_inputs))));
    return py::dict("value"_a = g.value, "values"_a = g.values, "parameters"_a = parameter_list(g.parameters),
                    "by_parameters"_a = array_of(std::move(g.by_parameters)),
                    "by_rest_positions"_a = array_of(std::move(g.by_rest_positions)), "guide_points"_a = guides,
                    "by_guide_points"_a = array_of(std::move(g.by_guide_points)), "by_tets"_a = tets,
                    "by_numbers"_a = array_of(std::move(g.by_numbers)), "inputs"_a = parameter_list(g.inputs),
                    "instants"_a = instants);
}

py::dict program_gradient(const Model& model, const std::vector<MeasureTuple>& measures, py::object judge,
                          bool rest_positions, bool guide_points, bool tets, std::vector<std::string> numbers, int kept,
                          py::object progress) {
    Watcher watcher(std::move(progress));
    const Watch watch = watcher.watch();
    Objective objective;
    for (const MeasureTuple& measure : measures) objective.measures.push_back(measure_of(measure));
    const Judge asked(std::move(judge), watcher);
    objective.judge = [&asked](int step, std::span<const double> values) { return asked(step, values); };
    const GradientOptions options{rest_positions, guide_points, tets, std::move(numbers), kept};
    std::optional<ProgramGradient> found;
    try {
        const Unlocked unlocked;
        found.emplace(gradient(model, objective, options, watch));
    } catch (const Failure&) {
        watcher.rethrow();
        throw;
    }
    return gradient_dict(std::move(*found));
}

}  // namespace

void add_inverse(py::module_& module) {
    add_inverse_result(module);
    add_workspace(module);
    add_identification(module);
    module.def("program_gradient", &program_gradient);
}

}  // namespace pliant::python
