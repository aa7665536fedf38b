// Derivatives of a state of equilibrium.
#include "pliant/linearisation.hpp"

#include <pybind11/stl.h>

#include <memory>

#include "arrays.hpp"
#include "interpreter.hpp"
#include "measures.hpp"
#include "parts.hpp"
#include "turns.hpp"
#include "values.hpp"

namespace pliant::python {
namespace {

/// A Linearisation shared by threads.
struct Shared {
    explicit Shared(const State& state) : at(state) {}
    Linearisation at;
    Turns turns{"linearisation"};
};

template <class Use>
auto locked(Shared& shared, const Use& use) {
    return shared.turns.take([&] { return use(shared.at); });
}

py::tuple change_tuple(Change change) {
    return py::make_tuple(array_of(std::move(change.positions)), array_of(std::move(change.tensions_N)),
                          array_of(std::move(change.pressures_Pa)));
}

py::tuple gradient_tuple(Linearisation::Gradient g) {
    return py::make_tuple(array_of(std::move(g.inputs)), array_of(std::move(g.parameters)),
                          array_of(std::move(g.rest_positions)), array_of(std::move(g.guide_points)));
}

template <std::vector<double> (Linearisation::*Product)(std::span<const double>) const>
py::array product(Shared& shared, const Numbers& v) {
    return array_of(locked(shared, [&](Linearisation& at) { return (at.*Product)(span_of(v)); }));
}
template <std::vector<double> (Linearisation::*Solution)(std::span<const double>)>
py::array solution(Shared& shared, const Numbers& b) {
    return array_of(locked(shared, [&](Linearisation& at) { return (at.*Solution)(span_of(b)); }));
}

std::vector<double> numbers_of(const Numbers& numbers) {
    return {numbers.data(), numbers.data() + numbers.size()};
}

py::tuple gradient(Shared& shared, const Numbers& by_positions, const Numbers& by_tensions, const Numbers& by_pressures,
                   bool guide_points) {
    const Quantity quantity{points_of(by_positions), numbers_of(by_tensions), numbers_of(by_pressures)};
    return gradient_tuple(locked(shared, [&](Linearisation& at) { return at.gradient(quantity, {guide_points}); }));
}

py::tuple gradient_of(Shared& shared, const MeasureTuple& measure, bool guide_points) {
    const Measure wanted = measure_of(measure);
    return gradient_tuple(locked(shared, [&](Linearisation& at) { return at.gradient(wanted, {guide_points}); }));
}

double dot(const std::vector<Point>& a, const std::vector<Point>& b) {
    double sum = 0;
    for (std::size_t n = 0; n < a.size(); ++n)
        for (std::size_t k = 0; k < 3; ++k) sum += a[n][k] * b[n][k];
    return sum;
}

/// (markers, 3, inputs): one solve per input.
py::array jacobian(Shared& shared, const std::vector<std::size_t>& markers, const std::vector<std::size_t>& inputs) {
    std::vector<double> numbers(3 * markers.size() * inputs.size());
    locked(shared, [&](Linearisation& at) {
        std::vector<Quantity> coordinates;
        for (const std::size_t marker : markers)
            for (std::size_t k = 0; k < 3; ++k)
                coordinates.push_back(
                    at.marker_coordinate(marker, {k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0}));
        for (std::size_t i = 0; i < inputs.size(); ++i) {
            const Change change = at.response_to_input(inputs[i]);
            for (std::size_t c = 0; c < coordinates.size(); ++c)
                numbers[c * inputs.size() + i] = dot(coordinates[c].by_positions, change.positions);
        }
        return 0;
    });
    return array_of(std::move(numbers))
        .reshape(Shape{static_cast<py::ssize_t>(markers.size()), 3, static_cast<py::ssize_t>(inputs.size())});
}

}  // namespace

void add_linearisation(py::module_& module) {
    py::class_<Shared>(module, "Linearisation")
        .def(py::init([](const State& state) {
            const State same = state;  // another thread may step the caller's meanwhile
            const Unlocked unlocked;
            return std::make_unique<Shared>(same);
        }))
        .def_property_readonly("size", [](const Shared& shared) { return shared.at.size(); })
        .def("multiply", &product<&Linearisation::multiply>)
        .def("multiply_transposed", &product<&Linearisation::multiply_transposed>)
        .def("solve", &solution<&Linearisation::solve>)
        .def("solve_transposed", &solution<&Linearisation::solve_transposed>)
        .def("change",
             [](Shared& shared, const Numbers& unknowns) {
                 return change_tuple(locked(shared, [&](Linearisation& at) { return at.change(span_of(unknowns)); }));
             })
        .def("inputs", [](const Shared& shared) { return parameter_list(shared.at.inputs()); })
        .def("parameters", [](const Shared& shared) { return parameter_list(shared.at.parameters()); })
        .def("response_to_input",
             [](Shared& shared, std::size_t input) {
                 return change_tuple(locked(shared, [&](Linearisation& at) { return at.response_to_input(input); }));
             })
        .def("guide_points",
             [](Shared& shared) {
                 py::list list;
                 for (const GuidePoint& one : locked(shared, [](Linearisation& at) { return at.guide_points(); }))
                     list.append(py::make_tuple(one.name, one.place));
                 return list;
             })
        .def("response_to_parameter",
             [](Shared& shared, std::size_t parameter) {
                 return change_tuple(
                     locked(shared, [&](Linearisation& at) { return at.response_to_parameter(parameter); }));
             })
        .def("gradient", &gradient)
        .def("gradient_of", &gradient_of)
        .def("value",
             [](Shared& shared, const MeasureTuple& measure) {
                 const Measure wanted = measure_of(measure);
                 return locked(shared, [&](Linearisation& at) { return at.value(wanted); });
             })
        .def("marker_coordinate",
             [](Shared& shared, std::size_t marker, const Point& direction) {
                 return array_of(locked(
                     shared, [&](Linearisation& at) { return at.marker_coordinate(marker, direction).by_positions; }));
             })
        .def("jacobian", &jacobian);
}

}  // namespace pliant::python
