// Batches of robots give the same bits as separate runs.
#include "pliant/batch.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <stdexcept>
#include <thread>

#include "library/simulation/test_bar.hpp"
#include "pliant/inverse.hpp"
#include "pliant/program.hpp"

using namespace pliant;
using test::bar;

namespace {

/// Each robot is pulled by another length.
std::vector<Inputs> pulled_each(const std::vector<State>& states, double shortening_m) {
    std::vector<Inputs> inputs;
    for (const State& state : states) {
        inputs.push_back(state.inputs());
        inputs.back().cables[0].value -= shortening_m * static_cast<double>(inputs.size());
    }
    return inputs;
}

}  // namespace

TEST_CASE("a batch gives the bits of its robots solved one after another, on any number of threads") {
    const Model one(bar()), other(bar("program.gravity = [0, 0, -9.81]\n"));
    const std::vector<Model> models = {one, other, one, one, other};
    std::vector<std::vector<State>> ends;
    for (const int threads : {1, 2, 5}) {
        Batch batch(models, {}, threads);
        CHECK(batch.size() == 5);
        CHECK(batch.threads() == threads);
        std::vector<State> states = batch.rest();
        for (int k = 0; k < 2; ++k)
            for (const StepResult& result : batch.step(states, pulled_each(states, 2e-4))) CHECK(result.arrived);
        ends.push_back(std::move(states));
    }
    for (std::size_t i = 0; i < models.size(); ++i) {
        Stepper stepper(models[i]);
        State state = stepper.rest();
        for (int k = 0; k < 2; ++k) {
            Inputs inputs = state.inputs();
            inputs.cables[0].value -= 2e-4 * static_cast<double>(i + 1);
            (void)stepper.step(state, inputs);
        }
        for (const auto& states : ends) CHECK((states[i] == state));
    }
}

TEST_CASE("a batch names the robot that cannot be stepped, and changes no state") {
    const Model model(bar());
    Batch batch({model, model, model}, {}, 2);
    std::vector<State> states = batch.rest();
    std::vector<Inputs> inputs = pulled_each(states, 1e-4);
    inputs[1].cables.clear();
    const std::vector<State> before = states;
    CHECK_THROWS_WITH_AS(batch.step(states, inputs),
                         "robot 1: the inputs drive 0 cables and 0 chambers; the robot has 1 and 0", Failure);
    CHECK((states[0] == before[0]));
    inputs.pop_back();
    CHECK_THROWS_WITH_AS(batch.step(states, inputs), "2 inputs for 3 robots", Failure);
    CHECK_THROWS_WITH_AS(Batch({model}, {}, -1), "the number of threads is negative", Failure);
    CHECK_THROWS_WITH_AS((void)batch.stepper(3), "there is no robot 3; there are 3", Failure);
}

TEST_CASE("a batch calls its watch on the calling thread only, and can be cancelled") {
    const Model model(bar());
    Batch batch({model, model, model, model}, {}, 3);
    std::vector<State> states = batch.rest();
    const std::thread::id here = std::this_thread::get_id();
    std::atomic<int> elsewhere = 0;
    const auto kind_of = [&](const Watch& watch) {
        try {
            (void)batch.step(states, pulled_each(states, 1e-3), watch);
        } catch (const Failure& failure) {
            return failure.kind();
        }
        return Failure::Kind::failed;
    };
    CHECK(kind_of([&](std::string_view, double) {
              if (std::this_thread::get_id() != here) ++elsewhere;
              return false;
          }) == Failure::Kind::cancelled);
    CHECK(elsewhere == 0);
    CHECK_THROWS_AS(batch.step(states, pulled_each(states, 1e-3),
                               [](std::string_view, double) -> bool { throw std::runtime_error("enough"); }),
                    std::runtime_error);
}

TEST_CASE("the watch of a batch without robots is told that all is done") {
    Batch batch({}, {});
    std::vector<State> states;
    std::vector<double> told;
    CHECK(batch
              .step(states, {},
                    [&](std::string_view, double share) {
                        told.push_back(share);
                        return true;
                    })
              .empty());
    CHECK(std::ranges::all_of(told, [](double share) { return share == 1; }));
}

TEST_CASE("work on each core passes on the exception of the lowest index") {
    std::atomic<int> done = 0;
    on_each_core(
        100, [&](std::size_t) { ++done; }, 3);
    CHECK(done == 100);
    on_each_core(0, [&](std::size_t) { ++done; });
    CHECK(done == 100);
    const auto odd = [](std::size_t i) {
        if (i % 2 == 1) throw std::runtime_error(std::to_string(i));
    };
    for (int k = 0; k < 20; ++k) CHECK_THROWS_WITH_AS(on_each_core(50, odd, 4), "1", std::runtime_error);
}

TEST_CASE("the options of a model are followed by everything that is done with it") {
    const Robot robot = bar("program = { steps = 2 }\n");
    const Model tight(robot, {.tolerance = 1e-9});
    Stepper stepper(tight), by_itself(tight, {.tolerance = 1e-9});
    State state = stepper.rest(), other = by_itself.rest();
    const Inputs inputs = stepper.program(1);
    CHECK(stepper.step(state, inputs).residual < 1e-9);
    (void)by_itself.step(other, inputs);
    CHECK(state == other);
    Batch batch({tight});
    std::vector<State> states = batch.rest();
    (void)batch.step(states, {inputs});
    CHECK(states[0] == state);
    const ProgramResult result = run(tight);
    CHECK(result.step(2).result.residual < 1e-9);
    CHECK_FALSE(run(Model(robot, {.iteration_limit = 1})).converged());
    const Model goal(bar("goal = [{ name = \"reach\", marker = \"tip\", tolerance = \"1 mm\", "
                         "plane = { point = [0, 0, 8], normal = [0, 0, 1] } }]\n"),
                     {.tolerance = 1e-9});
    CHECK(inverse(goal).waypoint(0).result.residual < 1e-9);
}

TEST_CASE("options of a model that are not possible are refused") {
    for (const double tolerance : {0.0, -1.0, 2.0, 1e-11, std::nan("")})
        CHECK_THROWS_WITH_AS((void)Model(bar(), {.tolerance = tolerance}), doctest::Contains("between 1e-10 and 0.1"),
                             Failure);
    CHECK_THROWS_WITH_AS((void)Model(bar(), {.iteration_limit = -1}), "the iteration limit is negative", Failure);
}

TEST_CASE("an empty function is no work for the cores") {
    CHECK_THROWS_WITH_AS(on_each_core(10, {}), "the work for each core is an empty function", Failure);
}

TEST_CASE("a batch that is at work refuses a second use") {
    const Model model(bar());
    Batch batch({model, model}, {}, 2);
    std::vector<State> states = batch.rest(), others = states;
    const std::vector<Inputs> inputs = pulled_each(states, 1e-3);
    bool asked = false;
    const Watch watch = [&](std::string_view, double) {
        if (asked) return true;
        asked = true;
        CHECK_THROWS_WITH_AS((void)batch.step(others, inputs), doctest::Contains("the batch is at work"), Failure);
        CHECK_THROWS_WITH_AS((void)batch.observe(others), doctest::Contains("the batch is at work"), Failure);
        return true;
    };
    (void)batch.step(states, inputs, watch);
    CHECK(asked);
    (void)batch.step(others, inputs);
    CHECK((states == others));
}
