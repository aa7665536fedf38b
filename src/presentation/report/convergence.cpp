#include "presentation/report/convergence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/core/csv.hpp"
#include "base/core/json.hpp"
#include "presentation/draw/plot.hpp"
#include "presentation/report/tables.hpp"

namespace pliant::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t most_rows = 4000;

const SolverRun& reference_of(std::span<const SolverRun> runs) {
    const auto newton = std::ranges::find(runs, sim::Solver::newton, &SolverRun::asked);
    return newton != runs.end() ? *newton : runs.front();
}

double difference_mm(const sim::Step& step, const sim::Trajectory& reference) {
    const auto index = static_cast<std::size_t>(step.index);
    if (index >= reference.steps.size()) return std::numeric_limits<double>::quiet_NaN();
    const sim::Step& other = reference.steps[index];
    double largest = 0;
    for (std::size_t m = 0; m < step.markers.size(); ++m)
        largest = std::max(largest, norm(step.markers[m].position_m - other.markers[m].position_m));
    if (step.markers.empty()) {
        for (std::size_t n = 0; n < step.positions.size(); ++n)
            largest = std::max(largest, norm(step.positions[n] - other.positions[n]));
    }
    return 1e3 * largest;
}

/// Number of records with a positive iteration number, without the starts of attempts.
int count_iterations(const sim::Trajectory& result) {
    return static_cast<int>(
        std::ranges::count_if(result.iterations, [](const sim::IterationRecord& r) { return r.iteration > 0; }));
}

}  // namespace

std::vector<SolverRow> compare(std::span<const SolverRun> runs) {
    std::vector<SolverRow> rows;
    for (const SolverRun& run : runs) {
        const sim::Step& last = run.result.steps.back();
        rows.push_back({std::string(sim::name(run.asked)), run.result.converged,
                        static_cast<int>(run.result.steps.size()) - 1, count_iterations(run.result), run.result.solve_s,
                        last.residual, last.energy_J, difference_mm(last, reference_of(runs).result),
                        run.result.message});
    }
    return rows;
}

std::string comparison_text(std::span<const SolverRow> rows) {
    std::string out = fmt::format("{:<14}{:>6}{:>12}{:>11}{:>12}{:>15}{:>15}\n", "solver", "steps", "iterations",
                                  "time, s", "residual", "energy, mJ", "off by, mm");
    for (const SolverRow& row : rows) {
        out += fmt::format("{:<14}{:>6}{:>12}{:>11.3f}{:>12.1e}{:>15.6g}{:>15.2e}\n", row.solver, row.steps,
                           row.iterations, row.solve_s, row.residual, 1e3 * row.energy_J, row.difference_mm);
    }
    for (const SolverRow& row : rows) {
        if (!row.converged) out += fmt::format("{}: {}\n", row.solver, row.message);
    }
    return out;
}

std::string comparison_json(std::span<const SolverRow> rows) {
    Json out = Json::array();
    for (const SolverRow& row : rows) {
        out.push_back({{"solver", row.solver},
                       {"converged", row.converged},
                       {"steps", row.steps},
                       {"iterations", row.iterations},
                       {"solve_s", row.solve_s},
                       {"residual", row.residual},
                       {"energy_J", row.energy_J},
                       {"difference_mm", row.difference_mm},
                       {"message", row.message}});
    }
    return json_text(out, 2) + "\n";
}

std::string comparison_csv(std::span<const SolverRow> rows) {
    std::string out = "solver,converged,steps,iterations,solve_s,residual,energy_J,difference_mm,message\n";
    for (const SolverRow& row : rows) {
        out += fmt::format("{},{},{},{},{:.6g},{:.10g},{:.10g},{:.10g},{}\n", row.solver, row.converged ? 1 : 0,
                           row.steps, row.iterations, row.solve_s, row.residual, row.energy_J, row.difference_mm,
                           csv_field(row.message));
    }
    return out;
}

std::string convergence_csv(std::span<const SolverRun> runs) {
    std::string out = "run,step,time,solver,iteration,residual,violation,energy_J,alpha,min_J\n";
    for (const SolverRun& run : runs) {
        for (const sim::IterationRecord& record : run.result.iterations)
            out += fmt::format("{},{}\n", sim::name(run.asked), iteration_row(record));
    }
    return out;
}

Result<std::string> convergence_png(std::span<const SolverRun> runs) {
    Plot plot{"How the solvers come to rest in the first step", "iterations", "residual", {}, true, true};
    for (const SolverRun& run : runs) {
        Series series{std::string(sim::name(run.asked)), {}, false};
        double count = 0;
        for (const sim::IterationRecord& record : run.result.iterations) {
            if (record.step == 1 && record.iteration > 0) series.points.push_back({++count, record.residual});
        }
        // auto usually equals one of the others: then one line has both names.
        const auto same = std::ranges::find_if(plot.series, [&](const Series& s) {
            return std::ranges::equal(s.points, series.points,
                                      [](const Point2& a, const Point2& b) { return a.x == b.x && a.y == b.y; });
        });
        if (same == plot.series.end())
            plot.series.push_back(std::move(series));
        else
            same->name += ", " + series.name;
    }
    return plot_png(plot);
}

std::string iterations_json(const sim::Trajectory& result) {
    std::vector<sim::Solver> solvers;
    Json out = {{"solvers", Json::array()}, {"rows", Json::array()}};
    const auto& records = result.iterations;
    const std::size_t stride = records.size() / most_rows + 1;
    for (std::size_t i = 0; i < records.size(); ++i) {
        const bool last = i + 1 == records.size() || records[i + 1].iteration == 0;
        if (i % stride != 0 && !last) continue;
        const auto place = std::ranges::find(solvers, records[i].solver);
        const auto index = place - solvers.begin();
        if (place == solvers.end()) {
            solvers.push_back(records[i].solver);
            out["solvers"].push_back(sim::name(records[i].solver));
        }
        out["rows"].push_back(Json::array({i, index, records[i].residual}));
    }
    return json_text(out);
}

}  // namespace pliant::report
