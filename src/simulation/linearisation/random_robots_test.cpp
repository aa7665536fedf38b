// Linearisations of random robots, where their programs lead, against differences.
//
// PLIANT_RANDOM_ROBOTS sets how many (8 unless told).
#include <doctest/doctest.h>

#include <cstdlib>

#include "simulation/linearisation/test_differences.hpp"
#include "simulation/run/test_random_program.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::testing;

namespace {

struct Worst {
    Measured error;
    unsigned product_seed = 0, input_seed = 0, solution_seed = 0;
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

}  // namespace

TEST_CASE("random robots, as far as their programs lead") {
    const char* wanted = std::getenv("PLIANT_RANDOM_ROBOTS");
    const unsigned count = wanted != nullptr ? static_cast<unsigned>(std::strtoul(wanted, nullptr, 10)) : 8;
    Worst worst;
    unsigned tried = 0, converged = 0;
    for (unsigned seed = 1; tried < count; ++seed) {
        const test::RandomProgram p = test::random_program(seed);
        const auto model = Model::create(p.robot);
        if (!model) continue;
        ++tried;
        CAPTURE(seed);
        CAPTURE(test::described(p));
        Equilibrium system(*model);
        const Settled settled = settle(system, 3, 1e-7, p.program.dynamics ? &p.program.dynamics->damping : nullptr);
        converged += settled.converged ? 1 : 0;
        auto at = Linearisation::create(system, settled.state, settled.controls);
        REQUIRE_MESSAGE(at, at.error().message);
        const Measured e = errors_of(*at, 0.25 * test::side, seed);
        CHECK(e.product < 1e-7);
        CHECK(e.transpose < 1e-13);
        CHECK(e.solution < 1e-12);
        note(e, seed, worst);
    }
    MESSAGE(converged, " of ", tried, " arrived; worst: products ", worst.error.product, " (seed ", worst.product_seed,
            "), transposed ", worst.error.transpose, ", solutions ", worst.error.solution, " (seed ",
            worst.solution_seed, "), inputs ", worst.error.input, " (seed ", worst.input_seed, ")");
    CHECK(converged > count / 4);
}
