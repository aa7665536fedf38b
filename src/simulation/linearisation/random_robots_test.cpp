// Linearisations of random robots against differences: where their programs lead or, where they lead nowhere in a few
// iterations, a little off their rest.
//
// PLIANT_RANDOM_ROBOTS sets how many (12 unless told).
#include <doctest/doctest.h>

#include <cstdlib>

#include "simulation/linearisation/test_differences.hpp"
#include "simulation/linearisation/test_robots.hpp"
#include "simulation/run/test_random_program.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::testing;

namespace {

struct Worst {
    Measured error;
    unsigned product_seed = 0, input_seed = 0, solution_seed = 0;
};

/// A random robot, now and then with what random_program leaves out: pressure on a patch with a free rim, a spring, a
/// roller, a rigid plate.
Description with_more(Description d, unsigned seed) {
    test::Dice dice(seed + 1000);
    const auto where = [&](const std::function<bool(Vec3)>& inside) { return reference::nodes_where(d.mesh, inside); };
    if (dice.chance(0.4)) {
        d.pressures = {patch(d.mesh, dice.between(0, 2) * test::side)};
        d.pressures[0].pressure_Pa = std::pow(10, dice.between(1, 3));
    }
    if (dice.chance(0.4)) {
        const Cable path = test::random_cable(dice, d.mesh, 0);
        // Not as long as at rest: where a band begins to pull its force has a kink.
        d.springs = {{"spring", path.points, std::pow(10, dice.between(-1, 3)), dice.between(0, 3) * test::side,
                      dice.chance(0.5)}};
    }
    if (dice.chance(0.3))
        d.supports.push_back({"roller",
                              where([](Vec3 p) { return p.y < 1e-9 && p.x > test::side; }),
                              {},
                              ramp(0, 1),
                              {},
                              {{0, dice.between(-1, 1), 1}}});
    if (dice.chance(0.2)) d.plates = {{"plate", where([](Vec3 p) { return p.x > 3 * test::side - 1e-9; })}};
    return d;
}

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
    const unsigned count = wanted != nullptr ? static_cast<unsigned>(std::strtoul(wanted, nullptr, 10)) : 12;
    Worst worst;
    unsigned tried = 0, moved = 0;
    for (unsigned seed = 1; tried < count; ++seed) {
        const test::RandomProgram p = test::random_program(seed);
        const auto model = Model::create(with_more(p.robot, seed));
        if (!model) continue;
        ++tried;
        CAPTURE(seed);
        CAPTURE(test::described(p));
        const Equilibrium system(*model);
        const Settled settled =
            settle(system, 2, 0.03, 1e-6, p.program.dynamics ? &p.program.dynamics->damping : nullptr);
        Noise noise(seed);
        State aside = settled.state;
        for (double& x : aside.x) x += 0.003 * test::side * noise();
        system.place_supports(settled.controls, aside.x);
        const bool stays = settled.settled > 0 || !system.evaluate(aside, settled.controls).possible();
        moved += settled.settled > 0 ? 1 : 0;
        auto at = Linearisation::create(system, stays ? settled.state : aside, settled.controls);
        REQUIRE_MESSAGE(at, at.error().message);
        const Measured e = errors_of(*at, 0.25 * test::side, seed);
        CHECK(e.product < 1e-7);
        CHECK(e.transpose < 1e-13);
        CHECK(e.solution < 1e-12);
        note(e, seed, worst);
    }
    MESSAGE(moved, " of ", tried, " left their rest; worst: products ", worst.error.product, " (seed ",
            worst.product_seed, "), transposed ", worst.error.transpose, ", solutions ", worst.error.solution,
            " (seed ", worst.solution_seed, "), inputs ", worst.error.input, " (seed ", worst.input_seed, ")");
    CHECK(3 * moved > count);
}
