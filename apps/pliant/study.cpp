// pliant study: any command over a plan of experiments, here or on a cluster.
#include <fmt/core.h>
#include <unistd.h>

#include <CLI/App.hpp>
#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "../usage.hpp"
#include "base/core/counted.hpp"
#include "base/core/files.hpp"
#include "base/core/own_core.hpp"
#include "base/core/parse_all.hpp"
#include "command.hpp"
#include "inputs.hpp"
#include "interrupt.hpp"
#include "loop/study/folder.hpp"
#include "loop/study/outcome.hpp"
#include "loop/study/run.hpp"
#include "loop/study/slurm.hpp"
#include "loop/study/study_file.hpp"
#include "output_option.hpp"
#include "presentation/study_plots/response_plots.hpp"
#include "printed.hpp"
#include "program.hpp"
#include "study_rows.hpp"

namespace pliant::app {
namespace {

namespace fs = std::filesystem;

struct StudyOptions {
    std::string study;
    std::string folder;
    std::string on = "local";
    int jobs = 0;
    int chunk = -1;
    int chunks = 1;       ///< from that one on
    bool others = false;  ///< and then what no other process has
    bool resume = false;
    bool plan_only = false;
    Output output;
};

std::string host_name() {
    std::array<char, 256> name{};
    return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

fs::path this_program() {
    std::error_code error;
    return fs::read_symlink("/proc/self/exe", error);
}

/// A whole number from the first of these environment variables that is set.
std::optional<std::size_t> number_of(std::initializer_list<const char*> names) {
    for (const char* name : names) {
        const char* const text = std::getenv(name);
        if (text == nullptr) continue;
        std::size_t number = 0;
        if (parse_all(text, number)) return number;
    }
    return std::nullopt;
}

/// The rank of this process among those started by mpirun or srun.
struct Rank {
    std::size_t rank = 0, size = 1;
};
Result<Rank> find_rank() {
    const auto rank = number_of({"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK", "SLURM_PROCID"});
    const auto size = number_of({"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_NTASKS"});
    if (!rank || !size || *size == 0 || *rank >= *size)
        return input_error(
            "--on mpi: neither mpirun nor srun started this; write mpirun -n 8 pliant study ... --on mpi");
    return Rank{*rank, *size};
}

study::RunSettings run_settings(int jobs, bool own_cores) {
    return {.worker = {this_program(), {std::string(study_rows_word), own_cores ? "one-core" : "all-cores"}},
            .jobs = jobs,
            .chunks = {},
            .place = host_name()};
}

Result<study::RunAccount> run_here(const StudyOptions& options, const study::Plan& plan, const fs::path& folder,
                                   Progress& progress) {
    const auto leader = study::lead(folder);
    if (!leader) return tl::unexpected(leader.error());
    const int jobs = options.jobs > 0 ? options.jobs : core_count();
    study::RunSettings settings = run_settings(jobs, jobs > 1);
    settings.chunks = study::all_chunks(plan);
    return study::run_rows(plan, folder, settings, progress);
}

Result<study::RunAccount> run_as_rank(const StudyOptions& options, const study::Plan& plan, const fs::path& folder,
                                      Rank rank, Progress& progress) {
    study::RunSettings settings = run_settings(std::max(options.jobs, 1), true);
    settings.chunks = study::all_chunks(plan, rank.rank, rank.size);
    settings.wait_for_others = rank.rank == 0;
    return study::run_rows(plan, folder, settings, progress);
}

Status run_by_slurm(const StudyOptions& options, const study::Plan& plan, const fs::path& folder, Progress& progress) {
    const auto leader = study::lead(folder);
    if (!leader) return tl::unexpected(leader.error());
    const auto account = study::run_on_slurm(plan, folder, {this_program(), options.jobs}, progress);
    if (!account) return tl::unexpected(account.error());
    return {};
}

/// A task on a cluster: runs the rows of one or a few chunks of a study that another process manages.
Result<int> run_chunk(const StudyOptions& options) {
    const auto plan = study::load_plan(options.study);
    if (!plan) return tl::unexpected(plan.error());
    if (plan->version != PLIANT_VERSION)
        return input_error("{}: was begun with pliant {}, and this is {}", options.study, plan->version,
                           PLIANT_VERSION);
    const auto first = static_cast<std::size_t>(options.chunk);
    if (first >= plan->chunk_count())
        return input_error("--chunk {}: the study has {} chunks, from 0 on", options.chunk, plan->chunk_count());
    auto progress = terminal_progress(options.output);
    study::RunSettings settings = run_settings(std::max(options.jobs, 1), true);
    settings.chunks = study::chunks_from(*plan, first, static_cast<std::size_t>(options.chunks), options.others);
    settings.wait_for_others = false;
    settings.stop_at_missing_path = false;
    settings.stop_at_wrong_input = false;
    constexpr int most_begun = 4;
    settings.most_begun = most_begun;
    const auto account = study::run_rows(*plan, options.study, settings, *progress);
    if (!account) return tl::unexpected(account.error());
    progress.reset();
    if (!options.output.quiet) fmt::print("{} run\n", counted(account->rows, "row"));
    return exit_done;
}

void print_figures(const study::Plan& plan, const study::ResultFigures& result) {
    if (result.count == 0) {
        fmt::print("{}: no row has this result\n", result.name);
        return;
    }
    fmt::print("{}: {:.6g} to {:.6g}, mean {:.6g}, standard deviation {:.3g}\n", result.name, result.least, result.most,
               result.mean, result.deviation);
    for (std::size_t k = 0; k < result.sensitivity.keys.size(); ++k) {
        const auto& [first, total] = result.sensitivity.keys[k];
        fmt::print("  {}: first {:.3f} ({:.3f} to {:.3f}), total {:.3f} ({:.3f} to {:.3f})\n", plan.keys[k].name,
                   first.value, first.low, first.high, total.value, total.low, total.high);
    }
}

Status draw_plots(const study::Plan& plan, const study::Collected& rows, const fs::path& folder) {
    const auto plots = report::response_plots(plan, rows);
    if (!plots) return tl::unexpected(plots.error());
    if (plots->empty()) return {};
    std::error_code error;
    fs::create_directories(folder / "plots", error);
    for (const auto& plot : *plots) {
        if (Status status = write_file(folder / "plots" / plot.file, plot.png); !status) return status;
    }
    return {};
}

/// Writes and prints the results, and returns the exit status.
Result<int> finish(const StudyOptions& options, const study::Plan& plan, const fs::path& folder,
                   const study::RunAccount* account) {
    const auto rows = study::collect(plan, folder);
    if (!rows) return tl::unexpected(rows.error());
    const auto figures = study::figures_of(plan, *rows);
    const std::string summary = study::summary_json(plan, *rows, figures, account);
    Status status = study::write_outcome(plan, folder, *rows, figures, summary);
    if (status) status = draw_plots(plan, *rows, folder);
    if (!status) return tl::unexpected(status.error());
    if (options.output.json) {
        fmt::print("{}", summary);
    } else if (!options.output.quiet) {
        fmt::print("{}: {} done, {} failed\n", counted(plan.rows.size(), "row"), rows->done, rows->failed);
        for (const auto& result : figures) print_figures(plan, result);
        fmt::print("results: {}, open results.csv there\n", folder.string());
    }
    if (rows->warned > 0) {
        const auto first = std::find_if(rows->rows.begin(), rows->rows.end(),
                                        [](const auto& row) { return row && row->done && !row->warning.empty(); });
        fmt::print(stderr, "{}: {} of {} rows have warnings; row {}: {}\n", options.study, rows->warned,
                   plan.rows.size(), (*first)->row, (*first)->warning);
    }
    if (rows->failed == 0) return exit_done;
    const auto first =
        std::find_if(rows->rows.begin(), rows->rows.end(), [](const auto& row) { return row && !row->done; });
    fmt::print(stderr, "{}: {} of {} rows failed; row {}: {}\n", options.study, rows->failed, plan.rows.size(),
               (*first)->row, (*first)->reason);
    return exit_failed;
}

fs::path results_folder(const StudyOptions& options) {
    if (!options.folder.empty()) return options.folder;
    return fs::path(options.study).stem().string() + "_study";
}

/// The error after a stop, which says what has been completed.
tl::unexpected<Error> stopped(const study::Plan& plan, const fs::path& folder, const Error& error) {
    if (error.cause != Cause::cancelled) return tl::unexpected(error);
    const auto rows = study::collect(plan, folder);
    const std::size_t recorded = rows ? rows->recorded() : 0;
    return tl::unexpected(Error{
        Cause::cancelled, fmt::format("cancelled: {} of {} rows are in {}; the same command with --resume continues",
                                      recorded, plan.rows.size(), folder.string())});
}

/// For unknown schedulers: prints what they have to run.
int tell_plan(const StudyOptions& options, const study::Plan& plan, const fs::path& folder) {
    if (options.output.json)
        print_json(
            nlohmann::json{{"folder", folder.string()}, {"rows", plan.rows.size()}, {"chunks", plan.chunk_count()}},
            -1);
    else if (!options.output.quiet)
        fmt::print("{} in {}, each of them a task: pliant study {} --chunk N, N from 0 to {}\n",
                   counted(plan.rows.size(), "row"), counted(plan.chunk_count(), "chunk"), folder.string(),
                   plan.chunk_count() - 1);
    return exit_done;
}

Result<int> run_study(const StudyOptions& options) {
    if (Status status = expect(FileKind::study, options.study); !status) return tl::unexpected(status.error());
    const std::vector<std::string> commands = commands_of_studies();
    const auto asked = study::load_study(options.study, {commands, PLIANT_VERSION});
    if (!asked) return tl::unexpected(asked.error());
    const bool mpi = options.on == "mpi";
    const Result<Rank> rank = mpi ? find_rank() : Result<Rank>(Rank{});
    if (!rank) return tl::unexpected(rank.error());
    const fs::path folder = results_folder(options);
    // Ranks start at different times: one may find records of another.
    const auto plan =
        study::open_folder(*asked, folder, options.resume || mpi ? study::Begin::resume : study::Begin::fresh);
    if (!plan) return tl::unexpected(plan.error());
    if (options.plan_only) return tell_plan(options, *plan, folder);
    Output shown = options.output;
    shown.quiet = shown.quiet || rank->rank != 0;
    auto progress = terminal_progress(shown);
    if (options.on == "slurm") {
        if (Status status = run_by_slurm(options, *plan, folder, *progress); !status)
            return stopped(*plan, folder, status.error());
        progress.reset();
        return finish(options, *plan, folder, nullptr);
    }
    const auto account =
        mpi ? run_as_rank(options, *plan, folder, *rank, *progress) : run_here(options, *plan, folder, *progress);
    if (!account) return stopped(*plan, folder, account.error());
    progress.reset();
    if (rank->rank != 0) return exit_done;
    return finish(options, *plan, folder, mpi ? nullptr : &*account);
}

Result<int> study_command(const StudyOptions& options) {
    std::error_code error;
    const bool is_folder = fs::is_directory(options.study, error);
    if (options.chunk >= 0 && !is_folder)
        return input_error("{}: --chunk takes the folder of a study, which pliant study STUDY.toml -o FOLDER makes",
                           options.study);
    if (options.chunk < 0 && is_folder)
        return input_error(
            "{}: is a folder; a study file is needed here, or --chunk N for a part of the study in the folder",
            options.study);
    return options.chunk >= 0 ? run_chunk(options) : run_study(options);
}

}  // namespace

void add_study(CLI::App& app, int& status) {
    auto options = std::make_shared<StudyOptions>();
    CLI::App* command = app.add_subcommand("study", "run any command over a plan of experiments, here or on a cluster");
    command->add_option("study", options->study, "study file (TOML); with --chunk the folder of a study")->required();
    add_output_path(*command, options->folder, "folder for rows and results (STUDY_study)");
    command
        ->add_option("--on", options->on,
                     "where the rows run: on this machine, as tasks of Slurm, or as ranks of mpirun or srun")
        ->check(CLI::IsMember({"local", "slurm", "mpi"}))
        ->capture_default_str();
    command
        ->add_option(
            "--jobs", options->jobs,
            "rows at a time (default: all cores; 1 in each rank); with --on slurm: tasks at a time (default: no limit)")
        ->check(between(1, 100000));
    command->add_flag("--resume", options->resume, "resume: keep the rows that are already in the folder");
    command->add_flag("--plan-only", options->plan_only,
                      "write the plan of the rows to the folder without running any");
    command
        ->add_option("--chunk", options->chunk,
                     "run only the rows of this chunk, counted from 0, as a task of a cluster does")
        ->check(between(0, 1000000));
    command->add_option("--chunks", options->chunks, "with --chunk: that many chunks, from that one on")
        ->check(between(1, 1000000))
        ->capture_default_str()
        ->needs("--chunk");
    command->add_flag("--others", options->others, "with --chunk: then also chunks that no other process has begun")
        ->needs("--chunk");
    add_output_options(*command, options->output, true);
    command->footer("Example: pliant study examples/study/finger.toml -o out");
    on_call(*command, status, [options] { return study_command(*options); });
}

}  // namespace pliant::app
