#include "pliant/gradient.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

#include "base/core/text.hpp"
#include "base/linalg/vectors.hpp"
#include "library/base/calls.hpp"
#include "library/simulation/data.hpp"
#include "library/simulation/guides.hpp"
#include "library/simulation/measures.hpp"
#include "robot/bodies/build.hpp"
#include "robot/file/robot_document.hpp"
#include "simulation/gradient/program_gradient.hpp"
#include "simulation/material/law_parameters.hpp"
#include "simulation/scene/number_models.hpp"
#include "simulation/solver/equilibrium.hpp"

namespace pliant {
namespace {

void expect_finite_judgement(const Judgement& judgement) {
    const auto is_finite = [](double number) { return std::isfinite(number); };
    if (is_finite(judgement.value) && std::ranges::all_of(judgement.slopes, is_finite)) return;
    throw Failure(Failure::Kind::input, "the objective gives a number that is not finite");
}

/// The objective with its measures by index. An exception of `judge` is stored and rethrown outside the solver.
class Judge {
public:
    Judge(const sim::Model& model, const Objective& asked) : asked_(asked) {
        if (!asked.judge) throw Failure(Failure::Kind::input, "the objective has no function that judges");
        for (const Measure& measure : asked.measures)
            objective_.measures.push_back(library::measure_for(model, measure));
        objective_.judge = [this](int step, std::span<const double> values) { return judged(step, values); };
    }
    Judge(const Judge&) = delete;
    Judge& operator=(const Judge&) = delete;
    [[nodiscard]] const sim::Objective& objective() const { return objective_; }
    void rethrow() const {
        if (thrown_) std::rethrow_exception(thrown_);
    }
    [[nodiscard]] bool failed() const { return thrown_ != nullptr; }

private:
    sim::Judgement judged(int step, std::span<const double> values) {
        if (thrown_) return {};
        try {
            Judgement judgement = asked_.judge(step, values);
            if (!judgement.slopes.empty() && judgement.slopes.size() != values.size())
                throw Failure(Failure::Kind::input, fmt::format("the objective gives {} slopes of {} measures",
                                                                judgement.slopes.size(), values.size()));
            expect_finite_judgement(judgement);
            return {judgement.value, std::move(judgement.slopes)};
        } catch (...) {
            thrown_ = std::current_exception();
        }
        return {};
    }

    const Objective& asked_;
    sim::Objective objective_;
    std::exception_ptr thrown_;
};

/// Cancels once the objective has thrown.
class JudgedProgress final : public Progress {
public:
    JudgedProgress(Progress& shown, const Judge& judge) : shown_(shown), judge_(judge) {}
    void advance(std::string_view stage, double fraction) override { shown_.advance(stage, fraction); }
    [[nodiscard]] bool cancelled() const override { return judge_.failed() || shown_.cancelled(); }

private:
    Progress& shown_;
    const Judge& judge_;
};

/// What the gradient is with respect to: from the rest state, where names and values are those of the whole program.
void add_names(const sim::Model& model, const sim::Program& program, ProgramGradient& out) {
    const sim::Equilibrium system(model);
    const auto at = library::value_of(sim::Linearisation::create(system, system.rest(), system.controls(0)));
    out.inputs = library::parameters_of(sim::inputs(at));
    out.parameters =
        library::parameters_of(sim::parameters(at, program.dynamics ? &program.dynamics->damping : nullptr));
}

/// An objective without slopes has an empty gradient in the engine: its derivatives are zero.
template <class T>
std::vector<T> or_zeros(std::vector<T> derivatives, std::size_t size) {
    derivatives.resize(size);
    return derivatives;
}

/// Derivative with respect to a number of the law of tet `t`.
double by_law(const material::LawParameter& number, const Eigen::MatrixXd& constants, std::size_t t) {
    if (constants.size() == 0) return 0;
    double slope = 0;
    for (std::size_t c = 0; c < number.direction.size(); ++c)
        slope += number.direction[c] * constants(static_cast<Eigen::Index>(c), static_cast<Eigen::Index>(t));
    return slope;
}

/// With respect to the constants of each tet's law, named as in robot files.
std::vector<TetGradient> by_tets(const sim::Model& model, const sim::TetDerivatives& of) {
    const sim::Description& d = model.description();
    std::vector<std::vector<material::LawParameter>> laws;
    for (const sim::Material& one : d.materials) laws.push_back(material::parameters(one.law));
    const std::size_t tets = d.mesh.tet_count();
    std::vector<TetGradient> out;
    const auto entry = [&](const std::string& name, const std::string& unit) -> std::vector<double>& {
        const auto there = std::ranges::find(out, name, &TetGradient::name);
        if (there != out.end()) return there->values;
        out.push_back({name, unit, std::vector<double>(tets, 0.0)});
        return out.back().values;
    };
    for (std::size_t t = 0; t < tets; ++t) {
        const int material = d.material_of_tet.empty()
                                 ? d.material_of_region[static_cast<std::size_t>(d.mesh.region[t])]
                                 : d.material_of_tet[t];
        for (const material::LawParameter& number : laws[static_cast<std::size_t>(material)])
            entry(number.name, number.unit)[t] = by_law(number, of.constants, t);
    }
    entry("density", "kg/m^3") = or_zeros(library::list_of(of.density), tets);
    return out;
}

/// Two robots for each of the requested numbers, and their equations.
struct Numbers {
    std::vector<std::unique_ptr<robot::NumberModels>> models;
    std::vector<std::unique_ptr<sim::Equilibrium>> systems;
    std::vector<sim::NumberChange> changes;
};

double value_of_number(const std::vector<std::pair<std::string, double>>& all, const std::string& name) {
    const auto found = std::ranges::find(all, name, &std::pair<std::string, double>::first);
    if (found != all.end()) return found->second;
    std::vector<std::string> names;
    for (const auto& [one, value] : all) names.push_back(one);
    const std::string nearest = nearest_name(name, names);
    throw Failure(Failure::Kind::input, names.empty()
                                            ? "the robot file has no [parameters] that are numbers"
                                            : fmt::format("[parameters] has no number \"{}\"; {}", name,
                                                          nearest.empty() ? "it has " + join_names(names)
                                                                          : "did you mean \"" + nearest + "\"?"));
}

Numbers numbers_around(const Model::Data& model, const std::vector<std::string>& names,
                       library::WatchedProgress& progress) {
    Numbers out;
    if (names.empty()) return out;
    const Robot::Data& given = *model.robot;
    const auto all = library::value_of(robot::free_parameters(given.text, given.file, given.changes));
    const auto read = [&](const std::vector<std::string>& more) { return library::read_again(given, more); };
    auto made =
        model.given_mesh ? robot::take_mesh(given.robot, *model.given_mesh) : robot::build_mesh(given.robot, progress);
    progress.rethrow();
    const mesh::TetMesh mesh = library::value_of(std::move(made));
    for (const std::string& name : names) {
        out.models.push_back(std::make_unique<robot::NumberModels>(
            library::value_of(robot::number_models(read, given.robot, mesh, name, value_of_number(all, name)))));
        const robot::NumberModels& around = *out.models.back();
        for (const sim::Model* one : {&around.more, &around.less})
            out.systems.push_back(std::make_unique<sim::Equilibrium>(*one));
        out.changes.push_back({(out.systems.end() - 2)->get(), out.systems.back().get(), around.step});
    }
    return out;
}

}  // namespace

ProgramGradient gradient(const Model& model, const Objective& objective, const GradientOptions& options,
                         const Watch& watch) {
    const robot::Scene& scene = model.data()->scene;
    if (options.kept < 1) throw Failure(Failure::Kind::input, "at least one state has to be kept");
    Judge judge(scene.model, objective);
    library::WatchedProgress watched(watch, "gradient");
    JudgedProgress progress(watched, judge);
    const Numbers numbers = numbers_around(*model.data(), options.numbers, watched);
    library::Guides guides;
    if (options.guide_points) guides = library::guides_of(*model.data());
    const sim::By by{.tets = options.tets,
                     .rest = options.rest_positions,
                     .guides = std::move(guides.points),
                     .numbers = numbers.changes};
    auto found =
        sim::program_gradient(scene.model, scene.robot.program, judge.objective(), {by, options.kept}, progress);
    watched.rethrow();
    judge.rethrow();
    const sim::ProgramGradient of = library::value_of(std::move(found));
    ProgramGradient out;
    out.value = of.value;
    out.values = of.values;
    add_names(scene.model, scene.robot.program, out);
    out.by_parameters = or_zeros(library::list_of(of.by.parameters), out.parameters.size());
    out.by_numbers = or_zeros(library::list_of(of.by.numbers), options.numbers.size());
    if (options.rest_positions)
        out.by_rest_positions = or_zeros(library::points_of(linalg::points_of(of.by.rest)), model.node_count());
    out.guide_points = std::move(guides.shown);
    out.by_guide_points = or_zeros(library::points_of(linalg::points_of(of.by.guides)), out.guide_points.size());
    if (options.tets) out.by_tets = by_tets(scene.model, of.by.tets);
    for (const auto& instant : of.instants)
        out.instants.push_back({instant.step, instant.time, library::list_of(instant.by_inputs)});
    return out;
}

}  // namespace pliant
