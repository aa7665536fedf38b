// Linearisations of random robots against differences: at states of their programs or, if these do not converge in a
// few iterations, slightly off the rest state.
//
// PLIANT_RANDOM_ROBOTS sets their number (default 12).
#include <doctest/doctest.h>

#include <cstdlib>
#include <functional>
#include <string>

#include "simulation/linearisation/test_random_robots.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::testing;

namespace {

struct Worst {
    Measured error;
    double parameter = 0;
    unsigned product_seed = 0, input_seed = 0, solution_seed = 0, parameter_seed = 0;
};

void note(const Measured& e, unsigned seed, Worst& worst) {
    if (e.product > worst.error.product) worst.product_seed = seed;
    if (e.input > worst.error.input) worst.input_seed = seed;
    if (e.solution > worst.error.solution) worst.solution_seed = seed;
    worst.error.product = std::max(worst.error.product, e.product);
    worst.error.transpose = std::max(worst.error.transpose, e.transpose);
    worst.error.solution = std::max(worst.error.solution, e.solution);
    worst.error.input = std::max(worst.error.input, e.input);
}

Eigen::VectorXd tail_only(Eigen::VectorXd rows, Eigen::Index free) {
    rows.head(free).setZero();
    return rows;
}

/// Forces caused by rounding the positions, N. At rest all forces are of this kind.
double force_of_rounding(const Linearisation& at) {
    Noise noise(7);
    constexpr double rounding = 1e-16;
    const Eigen::VectorXd v = at.state().x.lpNorm<Eigen::Infinity>() * some_direction(at, Side::direct, noise);
    return rounding * at.multiply(v).head(at.size() - static_cast<Eigen::Index>(at.solved().size())).norm();
}

/// dF/dp for all parameters of a robot, against robots with other values.
void note_parameters(Linearisation& at, unsigned seed, Worst& worst) {
    const std::vector<Parameter> all = parameters(at);
    // Magnitude of the forces, and of their change with a number by its own size: much smaller changes are lost in
    // rounding.
    double largest = at.system().evaluate(at.state(), at.controls()).out_of_balance.norm();
    for (const Parameter& p : all) {
        if (p.kind == Parameter::Kind::law)
            largest = std::max(largest, derivative(at, p).equations.norm() * size_of(p));
    }
    const double drowned_N = std::max(1e-13 * largest, force_of_rounding(at));
    for (const Parameter& p : all) {
        const Derivative by = derivative(at, p);
        const auto m = static_cast<Eigen::Index>(at.solved().size());
        // A row beside what it would be if all nodes moved by a share of the forces' change over their stiffness.
        Eigen::VectorXd least(m);
        for (Eigen::Index k = 0; k < m; ++k) {
            Eigen::VectorXd row = Eigen::VectorXd::Zero(at.size());
            row[at.size() - m + k] = 1;
            const double motion = std::max(by.direct.positions.norm(), 1e-9 * at.state().x.norm() / size_of(p));
            least[k] = 1e-3 * motion * at.motion_weights(row).norm();
        }
        const double error = best_error(0.02 * size_of(p), [&](double h) {
            const Eigen::VectorXd found = difference([&](double change) { return equations_with(at, p, change); }, h);
            const Eigen::Index n = at.size() - m;
            // Of the forces themselves, over the longest step that is tried.
            const double off_N = 0.02 * (found - by.equations).head(n).norm() * size_of(p);
            return off_N < drowned_N ? relative_error(at, tail_only(found, n), tail_only(by.equations, n), least)
                                     : relative_error(at, found, by.equations, least);
        });
        INFO(p.name);
        CHECK(error < 1e-7);
        if (error > worst.parameter) worst.parameter_seed = seed;
        worst.parameter = std::max(worst.parameter, error);
    }
}

}  // namespace

namespace {

unsigned wanted_robots(unsigned unless) {
    const char* wanted = std::getenv("PLIANT_RANDOM_ROBOTS");
    return wanted != nullptr ? static_cast<unsigned>(std::strtoul(wanted, nullptr, 10)) : unless;
}

/// Whatever `made` throws for each seed.
void try_robots(unsigned count, const std::function<test::RandomProgram(unsigned seed)>& made) {
    Worst worst;
    unsigned tried = 0, moved = 0;
    for (unsigned seed = 1; tried < count; ++seed) {
        const test::RandomProgram p = made(seed);
        const auto model = Model::create(p.robot);
        if (!model) continue;
        ++tried;
        CAPTURE(seed);
        const std::string robot = test::described(p);  // a capture is read only where a check fails
        CAPTURE(robot);
        RandomState random(*model, p, seed);
        moved += random.moved ? 1 : 0;
        auto at = Linearisation::create(random.system, random.state, random.controls);
        REQUIRE_MESSAGE(at, at.error().message);
        const Measured e = errors_of(*at, 0.25 * test::side, seed);
        CHECK(e.product < 1e-7);
        CHECK(e.transpose < 1e-13);
        CHECK(e.solution < 1e-12);
        note(e, seed, worst);
        note_parameters(*at, seed, worst);
    }
    MESSAGE(moved, " of ", tried, " left their rest; worst: products ", worst.error.product, " (seed ",
            worst.product_seed, "), transposed ", worst.error.transpose, ", solutions ", worst.error.solution,
            " (seed ", worst.solution_seed, "), inputs ", worst.error.input, " (seed ", worst.input_seed,
            "), parameters ", worst.parameter, " (seed ", worst.parameter_seed, ")");
    CHECK(3 * moved > count);
}

}  // namespace

TEST_CASE("linearisations of random robots, along their programs") {
    try_robots(wanted_robots(12), [](unsigned seed) {
        test::RandomProgram p = test::random_program(seed);
        p.robot = with_more(std::move(p.robot), seed);
        return p;
    });
}

TEST_CASE("linearisations of random free bodies with objects over a ground") {
    try_robots(wanted_robots(8), [](unsigned seed) { return test::random_free_program(seed); });
}
