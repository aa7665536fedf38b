// The table of docs/comparison.md, made again: the thesis' model, linear and quadratic tets, and CalculiX on the same
// meshes, one row per problem and Poisson ratio. CalculiX runs beside us (Debian package calculix-ccx) and its columns
// stay empty without it.
//   build/release/bench/pliant_compare [PROBLEM]...        all, or those named
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "simulation/peers/calculix.hpp"
#include "simulation/peers/comparison_problems.hpp"
#include "simulation/run/simulate.hpp"

using namespace pliant;
using namespace pliant::sim;

namespace {

using comparison::Drive;

struct Outcome {
    double tip_mm = 0;                ///< x of the interface (bar) or z of the end (others), displacement
    std::optional<double> actuation;  ///< force at the grip N, tension N or pressure kPa
    double wall_s = 0;
};
using Cell = std::optional<Outcome>;

struct Problem {
    std::string name;
    std::string actuation;  ///< what it is; empty: none
    bool sideways = false;  ///< the tip's x is reported instead of z
    std::function<Description(int order, bool blend, Drive drive)> describe;
    /// The same for CalculiX, driven by what we found.
    std::function<void(Description&, double found)> hand_over;
};

double tip_of(const Problem& problem, Vec3 u) {
    return 1e3 * (problem.sideways ? u.x : u.z);
}

std::optional<double> actuation_of(const Step& step) {
    if (!step.cables.empty()) return step.cables[0].tension_N;
    if (!step.chambers.empty()) return step.chambers[0].pressure_Pa / 1e3;
    if (step.supports.size() > 1) return step.supports[1].force_N.x;
    return {};
}

Cell ours(const Problem& problem, int order, bool blend, Drive drive) {
    const Description d = problem.describe(order, blend, drive);
    const auto model = Model::create(d);
    if (!model) return fmt::print(stderr, "{}: {}\n", problem.name, model.error().message), std::nullopt;
    Progress silent;
    const Trajectory t = run(*model, {.steps = 5, .tolerance = 1e-5}, silent);
    if (!t.converged) return fmt::print(stderr, "{}: {}\n", problem.name, t.message), std::nullopt;
    return Outcome{tip_of(problem, comparison::tip_displacement(d, t.steps.back())), actuation_of(t.steps.back()),
                   t.setup_s + t.solve_s};
}

Cell theirs(const Problem& problem, int order, const Cell& found) {
    if (!found || !calculix::installed()) return {};
    Description d = problem.describe(order, false, Drive::constraint);
    if (problem.hand_over) problem.hand_over(d, *found->actuation);
    const auto solution = calculix::solve(d);
    if (!solution) return fmt::print(stderr, "{}: {}\n", problem.name, solution.error().message), std::nullopt;
    Outcome outcome{tip_of(problem, calculix::displacement(*solution, d.markers[0].point)), {}, solution->wall_s};
    if (d.supports.size() > 1) outcome.actuation = calculix::support_force(*solution, d.supports[1]).x;
    if (problem.hand_over) outcome.actuation = found->actuation;
    return outcome;
}

std::string figure(const std::optional<double>& value) {
    return value ? fmt::format("{:.5g}", *value) : "-";
}

void print_row(const Problem& problem, double nu) {
    const Cell thesis = ours(problem, 1, true, Drive::elements);
    const Cell blend = ours(problem, 2, true, Drive::constraint);
    const Cell linear = ours(problem, 1, false, Drive::constraint);
    const Cell quadratic = ours(problem, 2, false, Drive::constraint);
    const Cell ccx_linear = theirs(problem, 1, linear);
    const Cell ccx_quadratic = theirs(problem, 2, quadratic);
    const auto line = [&](const std::string& what, const auto& pick) {
        fmt::print("| {} | {} | {} |", problem.name, nu, what);
        for (const Cell* cell : {&thesis, &blend, &linear, &ccx_linear, &quadratic, &ccx_quadratic})
            fmt::print(" {} |", figure(*cell ? pick(**cell) : std::optional<double>()));
        fmt::print("\n");
        std::fflush(stdout);
    };
    line(problem.sideways ? "interface x, mm" : "tip z, mm",
         [](const Outcome& o) { return std::optional<double>(o.tip_mm); });
    if (!problem.actuation.empty()) line(problem.actuation, [](const Outcome& o) { return o.actuation; });
    line("time, s", [](const Outcome& o) { return std::optional<double>(o.wall_s); });
}

material::Law rubber(double E, double nu, bool blend) {
    if (blend) return material::shape_blend(E, nu);
    return material::neo_hookean(E, nu);
}

std::vector<Problem> problems(double nu) {
    return {{"bar",
             "force, N",
             true,
             [nu](int order, bool blend, Drive) {
                 return comparison::bar(order, rubber(45e6, nu, blend), rubber(12e6, nu, blend), 0.3);
             },
             {}},
            {"beam",
             "",
             false,
             [nu](int order, bool blend, Drive) { return comparison::beam(order, rubber(12e6, nu, blend), 40); },
             {}},
            {"cable finger", "tension, N", false,
             [nu](int order, bool blend, Drive drive) {
                 return comparison::cable_finger(order, rubber(5e6, nu, blend), {CableTarget::Kind::length_ratio, 0.9},
                                                 drive);
             },
             [](Description& d, double tension) {
                 d.cables[0].target = {CableTarget::Kind::tension_N, tension};
             }},
            {"chamber", "pressure, kPa", false,
             [nu](int order, bool blend, Drive drive) {
                 return comparison::air_block(order, rubber(1e6, nu, blend), {ChamberTarget::Kind::volume_ratio, 1.25},
                                              drive);
             },
             [](Description& d, double pressure_kPa) {
                 d.chambers[0].target = {ChamberTarget::Kind::pressure_Pa, 1e3 * pressure_kPa};
             }}};
}

}  // namespace

int main(int argc, char** argv) {
    const std::vector<std::string> wanted(argv + 1, argv + argc);
    fmt::print(
        "| problem | nu | quantity | thesis | blend, quadratic | linear | CalculiX C3D4 | quadratic | CalculiX C3D10 "
        "|\n");
    fmt::print("|---|---|---|---|---|---|---|---|---|\n");
    for (std::size_t p = 0; p < problems(0.3).size(); ++p) {
        for (const double nu : {0.3, 0.45, 0.49}) {
            const Problem problem = problems(nu)[p];
            if (wanted.empty() || std::find(wanted.begin(), wanted.end(), problem.name) != wanted.end())
                print_row(problem, nu);
        }
    }
}
