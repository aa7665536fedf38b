// pliant-mpi: one robot on many machines. Started by mpirun or srun, as many times as there are ranks.
#include <fmt/core.h>
#include <petscsys.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <new>
#include <string>

#include "../standard_streams.hpp"
#include "../usage.hpp"
#include "base/core/error.hpp"
#include "simulate.hpp"
#include "simulation/distributed/petsc.hpp"

namespace {

using namespace pliant;
using sim::distributed::Preconditioner;

constexpr const char* about =
    "Simulates one robot on many machines: each rank has a part of it. Start it with mpirun or srun.";

Preconditioner preconditioner_of(const std::string& word) {
    if (word == "gamg") return Preconditioner::gamg;
    if (word == "hypre") return Preconditioner::hypre;
    throw CLI::ValidationError("--preconditioner", "write gamg or hypre, not " + word);
}

void add_options(CLI::App& command, app::Options& options) {
    command.add_option("robot", options.robot, "robot file (TOML)")->required();
    command.add_option("-o,--output", options.folder, "folder for the results; without it only a summary is printed");
    command.add_option("--steps", options.steps, "number of steps, in place of the file's")
        ->check(app::between(1, 100000));
    command.add_option("--set", options.assignments, "KEY=VALUE: change any key")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);
    command.add_option_function<std::string>(
        "--preconditioner", [&](const std::string& word) { options.preconditioner = preconditioner_of(word); },
        "gamg or hypre (gamg)");
    command.add_option("--frames-every", options.frames_every, "a frame for ParaView every so many steps; 0: none (1)")
        ->check(app::between(0, 100000));
    command
        .add_option("--checkpoint-every", options.checkpoint_every,
                    "write a checkpoint every so many steps, to FOLDER.checkpoint; 0: never (1)")
        ->check(app::between(0, 100000));
    command.add_flag("--resume", options.resume, "continue from FOLDER.checkpoint, on any number of ranks");
    command.add_flag("-q,--quiet", options.quiet, "print errors only");
    command.add_flag("--json", options.json, "print the summary as JSON");
    command.footer("Example: mpirun -n 4 pliant-mpi simulate examples/cable_gripper/gripper.toml -o out");
}

/// Runs on all ranks; root prints.
int run(const sim::distributed::Ranks& ranks, int argc, char** argv) {
    CLI::App app(about, "pliant-mpi");
    app.set_version_flag("--version", std::string(PLIANT_VERSION));
    app.require_subcommand(1);
    app::Options options;
    add_options(*app.add_subcommand("simulate", "run the actuation program of a robot file"), options);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() != 0) {
            const Error found = app::misspelt(app).value_or(app::usage_error(app::given_command(app), error));
            if (ranks.is_root()) fmt::print(stderr, "{}\n", found.message);
            return app::exit_bad_input;
        }
        if (ranks.is_root()) app.exit(error);
        return app::exit_done;
    }
    const Result<int> status = simulate(ranks, options);
    if (status) return *status;
    if (ranks.is_root()) fmt::print(stderr, "{}\n", status.error().message);
    return status.error().cause == Cause::input ? app::exit_bad_input : app::exit_failed;
}

/// One rank cannot continue, and the others wait for it: ends all.
int give_up(const char* why) {
    int rank = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    fmt::print(stderr, "pliant-mpi: rank {}: {}\n", rank, why);
    std::fflush(stderr);
    MPI_Abort(MPI_COMM_WORLD, app::exit_failed);
    return app::exit_failed;
}

}  // namespace

// Only an exception while an error is printed can escape, and the program is ending then.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    app::secure_standard_streams();
    // Errors are returned as values, and signals have their usual effect.
    PetscOptionsSetValue(nullptr, "-no_signal_handler", "true");
    if (PetscInitializeNoArguments() != 0) return app::exit_failed;
    PetscPushErrorHandler(PetscReturnErrorHandler, nullptr);
    int status = app::exit_failed;
    try {
        status = run(sim::distributed::Ranks(PETSC_COMM_WORLD), argc, argv);
    } catch (const sim::distributed::LibraryFailure& failure) {
        return give_up(failure.what());
    } catch (const std::bad_alloc&) {
        return give_up("out of memory");
    }
    PetscFinalize();
    return status;
}
