// Reduced models through the public interface.
#include "pliant/reduced.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "library/simulation/test_bar.hpp"

using namespace pliant;
using test::bar;

namespace {

Inputs shortened(const Model& model, double length_m) {
    Inputs inputs = Stepper(model).program(1);
    inputs.cables[0] = {Drive::By::length, length_m};
    return inputs;
}

double distance(const Point& a, const Point& b) {
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

}  // namespace

TEST_CASE("a reduced model is near the whole robot, knows by how much, and leads back to it") {
    const Model model(bar());
    const ReducedModel reduced = reduce(model, {.samples = 12});
    CHECK(reduced.mode_count() < 12);
    CHECK(reduced.tet_count() < model.tet_count());
    CHECK(reduced.sample_count() == 12);
    CHECK(reduced.notes().empty());
    REQUIRE(reduced.inputs().size() == 1);
    CHECK(reduced.inputs()[0].name == "flexor");

    const Inputs inputs = shortened(model, 0.0553);
    ReducedStepper stepper(reduced);
    ReducedState state = stepper.start();
    const ReducedStep step = stepper.step(state, inputs);
    REQUIRE(step.found);
    CHECK(step.iterations > 0);
    CHECK(state.inputs().cables[0] == inputs.cables[0]);
    CHECK(state.amplitudes().size() == reduced.mode_count());

    Stepper whole_stepper(model);
    State whole = whole_stepper.rest();
    REQUIRE(whole_stepper.step(whole, inputs).arrived);
    const Observation seen = whole_stepper.observe(whole);
    const ReducedError error = stepper.estimate(state);
    REQUIRE(error.markers_m.size() == 1);
    CHECK(error.error_m >= error.markers_m[0]);
    CHECK(distance(state.markers()[0], seen.markers[0].position_m) < 2e-5);
    CHECK(state.tensions_N()[0] == near(seen.cables[0].tension_N, {.relative = 5e-3}));
    CHECK(state.pressures_Pa().empty());
    CHECK(state.positions().size() == model.node_count());
    const Observation exact = whole_stepper.observe(stepper.exact(state));
    CHECK(distance(exact.markers[0].position_m, seen.markers[0].position_m) < 1e-6);
}

TEST_CASE("a reduced model is stored, and read for the same robot only") {
    const test::Folder folder;
    const Model model(bar());
    const ReducedModel reduced = reduce(model, {.samples = 6});
    reduced.save(folder / "bar.reduced");
    const ReducedModel again = ReducedModel::load(model, folder / "bar.reduced");
    CHECK(again.mode_count() == reduced.mode_count());
    const Inputs inputs = shortened(model, 0.055);
    ReducedStepper one(reduced), other(again);
    ReducedState a = one.start(), b = other.start();
    REQUIRE(one.step(a, inputs).found);
    REQUIRE(other.step(b, inputs).found);
    CHECK(a.amplitudes() == b.amplitudes());
    CHECK_THROWS_WITH_AS((void)one.step(b, inputs), "the state is one of another reduced model", Failure);
    const Model longer(bar("program.steps = 3\n"));
    CHECK_THROWS_AS((void)ReducedModel::load(longer, folder / "bar.reduced"), Failure);
    CHECK_THROWS_AS((void)ReducedModel::load(model, folder / "none.reduced"), Failure);
}

TEST_CASE("a reduced model is compared with the whole robot at other inputs") {
    const ReducedModel reduced = reduce(Model(bar()), {.samples = 12});
    const auto checks = check_reduction(reduced, 4);
    REQUIRE(checks.size() == 4);
    for (const ReductionCheck& check : checks) {
        REQUIRE(check.found);
        CHECK(check.error_m < 0.01 * check.motion_m);
        CHECK(check.estimated_m > 0.3 * check.error_m);
        CHECK(check.force_error < 0.01);
    }
    CHECK_THROWS_AS((void)check_reduction(reduced, -1), Failure);
    CHECK_THROWS_AS((void)reduce(Model(bar()), {.samples = -1}), Failure);
    CHECK_THROWS_AS((void)reduce(Model(bar()), {}, [](std::string_view, double) { return false; }), Failure);
}

TEST_CASE("a model that uses nearly all modes of its samples says that its estimate means little") {
    const ReducedModel reduced = reduce(Model(bar()), {.samples = 4});
    REQUIRE(reduced.notes().size() == 1);
    CHECK(reduced.notes()[0].find("leaves few to estimate its error from") != std::string::npos);
}
