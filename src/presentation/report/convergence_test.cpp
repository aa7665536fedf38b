#include "presentation/report/convergence.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::report;

namespace {

/// `steps` steps of `iterations` each; the tip moves along x by 1 mm a step, and `off_mm` too far.
SolverRun run_of(sim::Solver solver, int steps, int iterations, double off_mm) {
    SolverRun run{solver, {}};
    run.result.steps.push_back({});
    run.result.steps[0].markers = {{"tip", {}}};
    for (int k = 1; k <= steps; ++k) {
        for (int i = 0; i <= iterations; ++i)
            run.result.iterations.push_back({.step = k,
                                             .time = 0.5 * k,
                                             .solver = solver,
                                             .iteration = i,
                                             .residual = std::pow(10, -i),
                                             .alpha = i == 0 ? 0.0 : 1.0});
        sim::Step step;
        step.index = k;
        step.residual = std::pow(10, -iterations);
        step.energy_J = 0.25;
        step.markers = {{"tip", {1e-3 * (k + off_mm), 0, 0}}};
        run.result.steps.push_back(step);
    }
    run.result.solve_s = 1.5;
    return run;
}

std::size_t lines_in(const std::string& text) {
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace

TEST_CASE("solvers are compared with Newton at the last step that all reached") {
    std::vector<SolverRun> runs = {run_of(sim::Solver::local_global, 1, 7, 0.125),
                                   run_of(sim::Solver::newton, 2, 3, 0)};
    runs[0].result.converged = false;
    runs[0].result.message = "stopped at step 2 of 2: no convergence, it \"says\"";
    const auto rows = compare(runs);
    REQUIRE(rows.size() == 2);
    CHECK(rows[0].solver == "local-global");
    CHECK_FALSE(rows[0].converged);
    CHECK(rows[0].steps == 1);
    CHECK(rows[0].iterations == 7);
    CHECK(rows[0].difference_mm == near(0.125, {.relative = 1e-12}));
    CHECK(rows[1].iterations == 6);
    CHECK(rows[1].difference_mm == 0);

    std::swap(runs[0], runs[1]);
    runs[0].asked = sim::Solver::anderson;  // now the first one is the reference, and it stops early
    runs[0].result.steps.pop_back();
    runs[0].result.steps.pop_back();
    CHECK(std::isnan(compare(runs)[1].difference_mm));

    const std::string csv = comparison_csv(rows);
    CHECK(lines_in(csv) == 3);
    CHECK(csv.find("local-global,0,1,7,1.5,1e-07,0.25,0.125,\"stopped at step 2 of 2: no convergence, it "
                   "\"\"says\"\"\"\n") != std::string::npos);
    CHECK(comparison_text(rows).find("local-global: stopped at step 2") != std::string::npos);
    const auto json = nlohmann::json::parse(comparison_json(rows));
    CHECK(json[1]["solver"] == "newton");
    CHECK(json[1]["iterations"] == 6);
}

TEST_CASE("convergence.csv has every iteration of every run; the picture shows those of the first step") {
    const std::vector<SolverRun> runs = {run_of(sim::Solver::anderson, 2, 5, 0), run_of(sim::Solver::newton, 2, 3, 0)};
    const std::string csv = convergence_csv(runs);
    CHECK(lines_in(csv) == 1 + 2 * 6 + 2 * 4);
    CHECK(
        csv.starts_with("run,step,time,solver,iteration,residual,violation,energy_J,alpha,min_J\n"
                        "anderson,1,0.5,anderson,0,1,0,0,0,1\nanderson,1,0.5,anderson,1,0.1,0,0,1,1\n"));
    const auto picture = convergence_png(runs);
    REQUIRE(picture);
    CHECK(picture->substr(1, 3) == "PNG");
    // The plot depends on the first step only.
    auto second = runs;
    second[0].result.iterations[8].residual = 0.5;
    REQUIRE(second[0].result.iterations[8].step == 2);
    CHECK(*convergence_png(second) == *picture);
    auto first = runs;
    first[0].result.iterations[2].residual = 0.5;
    CHECK(*convergence_png(first) != *picture);
}

TEST_CASE("the page gets a limited number of iterations, including the last of every attempt") {
    const auto few = nlohmann::json::parse(iterations_json(run_of(sim::Solver::newton, 2, 3, 0).result));
    CHECK(few["solvers"] == nlohmann::json::array({"newton"}));
    CHECK(few["rows"].size() == 8);
    CHECK(few["rows"][5][0] == 5);
    CHECK(few["rows"][5][2].get<double>() == near(0.1, {.relative = 1e-12}));

    auto mixed = run_of(sim::Solver::local_global, 3, 9999, 0).result;
    mixed.iterations.back().solver = sim::Solver::anderson;
    const auto many = nlohmann::json::parse(iterations_json(mixed));
    CHECK(many["rows"].size() < 4100);
    CHECK(many["rows"].size() > 3000);
    CHECK(many["solvers"].size() == 2);
    for (const int last : {9999, 19999, 29999}) {
        const auto& rows = many["rows"];
        CHECK(std::any_of(rows.begin(), rows.end(), [&](const auto& row) { return row[0] == last; }));
    }
}
