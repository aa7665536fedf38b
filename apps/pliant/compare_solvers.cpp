#include "compare_solvers.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

#include "base/core/files.hpp"
#include "interrupt.hpp"
#include "presentation/report/convergence.hpp"

namespace pliant::app {
namespace {

namespace fs = std::filesystem;

Status write_comparison(const std::string& folder, const std::vector<report::SolverRun>& runs,
                        const std::vector<report::SolverRow>& rows) {
    const Result<std::string> picture = report::convergence_png(runs);
    if (!picture) return tl::unexpected(picture.error());
    return write_folder(folder, "comparison.json", [&](const fs::path& path) -> Status {
        if (Status s = write_file(path / "comparison.json", report::comparison_json(rows)); !s) return s;
        if (Status s = write_file(path / "comparison.csv", report::comparison_csv(rows)); !s) return s;
        if (Status s = write_file(path / "convergence.csv", report::convergence_csv(runs)); !s) return s;
        return write_file(path / "convergence.png", *picture);
    });
}

}  // namespace

Result<std::vector<sim::Solver>> read_solvers(const std::string& list) {
    std::vector<sim::Solver> solvers;
    for (std::size_t at = 0; at <= list.size();) {
        const std::size_t end = std::min(list.find(',', at), list.size());
        const std::string name = list.substr(at, end - at);
        const auto solver = sim::solver_named(name);
        if (!solver)
            return input_error(
                "--solver: \"{}\" is none of local-global, anderson, quasi-newton, newton, auto; write one, or several "
                "with commas between them",
                name);
        if (std::ranges::find(solvers, *solver) != solvers.end())
            return input_error("--solver: {} is there twice", name);
        solvers.push_back(*solver);
        at = end + 1;
    }
    return solvers;
}

Result<int> compare_solvers(const sim::Model& model, const sim::Program& program,
                            const std::vector<sim::Solver>& solvers, const std::string& folder, const Output& output) {
    std::vector<report::SolverRun> runs;
    const auto progress = terminal_progress(output);
    for (const sim::Solver solver : solvers) {
        sim::Program own = program;
        own.solver = solver;
        runs.push_back({solver, sim::run(model, own, *progress)});
        if (progress->cancelled()) break;
    }
    const std::vector<report::SolverRow> rows = report::compare(runs);
    if (!folder.empty()) {
        on_signal(OnSignal::ask_twice);
        if (const Status written = write_comparison(folder, runs, rows); !written)
            return tl::unexpected(written.error());
    }
    if (output.json)
        fmt::print("{}", report::comparison_json(rows));
    else if (!output.quiet)
        fmt::print("{}", report::comparison_text(rows));
    const bool some = std::ranges::any_of(rows, &report::SolverRow::converged);
    return some && !progress->cancelled() ? exit_done : exit_failed;
}

}  // namespace pliant::app
