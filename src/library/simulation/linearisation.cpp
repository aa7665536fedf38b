#include "pliant/linearisation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/linalg/vectors.hpp"
#include "library/base/calls.hpp"
#include "library/base/in_use.hpp"
#include "library/simulation/data.hpp"
#include "library/simulation/guides.hpp"
#include "library/simulation/measures.hpp"
#include "simulation/gradient/guide_points.hpp"
#include "simulation/gradient/variation.hpp"
#include "simulation/linearisation/parameters.hpp"
#include "simulation/linearisation/rest_positions.hpp"

namespace pliant {
namespace {

void expect_size(std::size_t size, std::size_t wanted, const char* what) {
    if (size == wanted) return;
    throw Failure(Failure::Kind::input, fmt::format("{} has {} entries; it takes {}", what, size, wanted));
}

void expect_finite(std::span<const double> numbers, const char* what) {
    if (std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); })) return;
    throw Failure(Failure::Kind::input, fmt::format("{} has a number that is not finite", what));
}

}  // namespace

struct Linearisation::Work {
    explicit Work(const State& state)
        : model(state.data().model),
          system(model->scene.model),
          at(library::value_of(
              sim::Linearisation::create(system, state.data().robot.now.state, state.data().robot.controls))),
          inputs(sim::inputs(at)),
          parameters(sim::parameters(at)),
          shown_inputs(library::parameters_of(inputs)),
          shown_parameters(library::parameters_of(parameters)) {}

    [[nodiscard]] Eigen::VectorXd unknowns(std::span<const double> v) const {
        expect_size(v.size(), static_cast<std::size_t>(at.size()), "the vector");
        expect_finite(v, "the vector");
        return Eigen::Map<const Eigen::VectorXd>(v.data(), at.size());
    }
    [[nodiscard]] Change shown_change(const sim::Change& change) const;
    [[nodiscard]] sim::Quantity quantity(const Quantity& asked) const;
    [[nodiscard]] Change response(const std::vector<sim::Parameter>& of, std::size_t index, const char* what);
    [[nodiscard]] const library::Guides& all_guides() {
        if (!guides) guides = library::guides_of(*model);
        return *guides;
    }

    std::shared_ptr<const Model::Data> model;
    sim::Equilibrium system;
    sim::Linearisation at;
    std::vector<sim::Parameter> inputs, parameters;
    std::vector<Parameter> shown_inputs, shown_parameters;
    std::optional<library::Guides> guides;  ///< created on first request
    library::InUse in_use{"linearisation"};
};

/// Multipliers of chambers are minus their pressures; those of pressure loads are internal.
Change Linearisation::Work::shown_change(const sim::Change& change) const {
    const sim::Description& d = model->scene.model.description();
    Change out;
    out.positions = library::points_of(linalg::points_of(change.positions));
    const auto cables = static_cast<Eigen::Index>(d.cables.size()),
               chambers = static_cast<Eigen::Index>(d.chambers.size());
    out.tensions_N = library::list_of(change.multipliers.head(cables));
    out.pressures_Pa = library::list_of(-change.multipliers.segment(cables, chambers));
    return out;
}

sim::Quantity Linearisation::Work::quantity(const Quantity& asked) const {
    const sim::Description& d = model->scene.model.description();
    const auto cables = static_cast<Eigen::Index>(d.cables.size()),
               chambers = static_cast<Eigen::Index>(d.chambers.size());
    sim::Quantity q{Eigen::VectorXd::Zero(at.state().x.size()), Eigen::VectorXd::Zero(at.state().multiplier.size())};
    if (!asked.by_positions.empty()) {
        expect_size(asked.by_positions.size(), model->scene.model.node_count(), "by_positions");
        for (const Point& p : asked.by_positions) expect_finite(p, "by_positions");
        for (std::size_t n = 0; n < asked.by_positions.size(); ++n)
            for (std::size_t k = 0; k < 3; ++k)
                q.by_positions[static_cast<Eigen::Index>(3 * n + k)] = asked.by_positions[n][k];
    }
    if (!asked.by_tensions.empty()) {
        expect_size(asked.by_tensions.size(), d.cables.size(), "by_tensions");
        expect_finite(asked.by_tensions, "by_tensions");
        q.by_multipliers.head(cables) = Eigen::Map<const Eigen::VectorXd>(asked.by_tensions.data(), cables);
    }
    if (!asked.by_pressures.empty()) {
        expect_size(asked.by_pressures.size(), d.chambers.size(), "by_pressures");
        expect_finite(asked.by_pressures, "by_pressures");
        q.by_multipliers.segment(cables, chambers) =
            -Eigen::Map<const Eigen::VectorXd>(asked.by_pressures.data(), chambers);
    }
    return q;
}

Change Linearisation::Work::response(const std::vector<sim::Parameter>& of, std::size_t index, const char* what) {
    if (index >= of.size())
        throw Failure(Failure::Kind::input, fmt::format("there is no {} {}; there are {}", what, index, of.size()));
    return shown_change(library::value_of(at.response(sim::derivative(at, of[index]))));
}

Linearisation::Linearisation(const State& state) : work_(std::make_unique<Work>(state)) {}
Linearisation::Linearisation(Linearisation&&) noexcept = default;
Linearisation& Linearisation::operator=(Linearisation&&) noexcept = default;
Linearisation::~Linearisation() = default;

std::size_t Linearisation::size() const {
    return static_cast<std::size_t>(work_->at.size());
}
std::vector<double> Linearisation::multiply(std::span<const double> v) const {
    return library::list_of(work_->at.multiply(work_->unknowns(v)));
}
std::vector<double> Linearisation::multiply_transposed(std::span<const double> w) const {
    return library::list_of(work_->at.multiply_transposed(work_->unknowns(w)));
}
std::vector<double> Linearisation::solve(std::span<const double> b) {
    const library::Use use(work_->in_use);
    return library::list_of(library::value_of(work_->at.solve(work_->unknowns(b))));
}
std::vector<double> Linearisation::solve_transposed(std::span<const double> b) {
    const library::Use use(work_->in_use);
    return library::list_of(library::value_of(work_->at.solve_transposed(work_->unknowns(b))));
}
Change Linearisation::change(std::span<const double> unknowns) const {
    return work_->shown_change(work_->at.change_of(work_->unknowns(unknowns)));
}

const std::vector<Parameter>& Linearisation::inputs() const {
    return work_->shown_inputs;
}
const std::vector<Parameter>& Linearisation::parameters() const {
    return work_->shown_parameters;
}

const std::vector<GuidePoint>& Linearisation::guide_points() {
    const library::Use use(work_->in_use);
    return work_->all_guides().shown;
}

Change Linearisation::response_to_input(std::size_t input) {
    const library::Use use(work_->in_use);
    return work_->response(work_->inputs, input, "input");
}
Change Linearisation::response_to_parameter(std::size_t parameter) {
    const library::Use use(work_->in_use);
    return work_->response(work_->parameters, parameter, "parameter");
}

Linearisation::Gradient Linearisation::gradient(const Quantity& quantity, const StateGradientOptions& options) {
    const library::Use use(work_->in_use);
    const sim::Adjoint adjoint = library::value_of(work_->at.adjoint(work_->quantity(quantity)));
    Gradient out;
    out.inputs = library::list_of(sim::derivatives(work_->at, adjoint, work_->inputs));
    out.parameters = library::list_of(sim::derivatives(work_->at, adjoint, work_->parameters));
    out.rest_positions = library::points_of(linalg::points_of(sim::rest_gradient(work_->at, adjoint)));
    if (!options.guide_points) return out;
    const auto actuators = static_cast<Eigen::Index>(work_->system.actuators().size());
    const Eigen::VectorXd by_guides =
        sim::guide_gradient(work_->at, adjoint, {}, Eigen::VectorXd::Zero(actuators), work_->all_guides().points);
    out.guide_points = library::points_of(linalg::points_of(by_guides));
    return out;
}

double Linearisation::value(const Measure& measure) const {
    return sim::slope(work_->at, library::measure_for(work_->model->scene.model, measure)).value;
}

Linearisation::Gradient Linearisation::gradient(const Measure& measure, const StateGradientOptions& options) {
    const library::Use use(work_->in_use);
    const sim::Slope slope = sim::slope(work_->at, library::measure_for(work_->model->scene.model, measure));
    sim::By wanted{.rest = true};
    if (options.guide_points) wanted.guides = work_->all_guides().points;
    const sim::Variation by = library::value_of(sim::gradient(work_->at, slope, wanted));
    return {library::list_of(by.inputs), library::list_of(by.parameters),
            library::points_of(linalg::points_of(by.rest)), library::points_of(linalg::points_of(by.guides))};
}

Quantity Linearisation::marker_coordinate(std::size_t marker, const Point& direction) const {
    const std::size_t markers = work_->model->scene.model.description().markers.size();
    if (marker >= markers)
        throw Failure(Failure::Kind::input, fmt::format("there is no marker {}; there are {}", marker, markers));
    expect_finite(direction, "the direction");
    const sim::Quantity q = sim::marker_coordinate(work_->system, marker, {direction[0], direction[1], direction[2]});
    return {library::points_of(linalg::points_of(q.by_positions)), {}, {}};
}

}  // namespace pliant
