#include "simulate.hpp"

#include <fmt/core.h>
#include <sys/resource.h>

#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include "base/core/checkpoint_folder.hpp"
#include "base/core/digest.hpp"
#include "base/core/files.hpp"
#include "base/core/own_core.hpp"
#include "base/core/stopwatch.hpp"
#include "ending.hpp"
#include "presentation/report/results.hpp"
#include "presentation/report/summary.hpp"
#include "results.hpp"
#include "robot/bodies/build.hpp"
#include "robot/file/robot_document.hpp"
#include "robot/file/robot_file.hpp"
#include "simulation/distributed/abilities.hpp"
#include "simulation/distributed/checkpoint.hpp"
#include "simulation/distributed/distribute.hpp"
#include "simulation/distributed/frames.hpp"
#include "simulation/distributed/run.hpp"
#include "simulation/distributed/self_contact_check.hpp"
#include "simulation/scene/build_description.hpp"

namespace pliant::app {
namespace {

namespace fs = std::filesystem;
using sim::distributed::Checkpoint;
using sim::distributed::DistributedEquilibrium;
using sim::distributed::Frames;
using sim::distributed::Ranks;

/// What root needs for the results after the robot is distributed; empty on other ranks.
struct RobotData {
    std::string name;
    mesh::TetMesh mesh;
    std::vector<std::string> warnings;
    double mesh_s = 0;
    std::optional<sim::ContactRules> contact;
    std::optional<CheckpointFolder> kept;  ///< with frames and checkpoint; no other job gets it while this one runs
};

/// Settings that all ranks need before the robot is distributed.
struct Job {
    sim::Program program;
    std::string origin;  ///< identifies the robot of a checkpoint
};

constexpr const char* kept_mark = "frames";  // what a folder beside the results is known by

fs::path kept_folder(const Options& options) {
    return beside_folder(options.folder, ".checkpoint");
}

/// `text`: of the robot file; `base`: of the robot that it stands on; `files`: digest of the files that they name.
std::string digest_of(const std::string& text, const std::optional<std::string>& base, const std::string& files,
                      const std::vector<std::string>& assignments, const mesh::TetMesh& mesh) {
    Digest digest;
    digest.add(text.data(), text.size());
    if (base) digest.add(base->data(), base->size());
    digest.add(files.data(), files.size());
    for (const std::string& change : assignments) digest.add(change.data(), change.size());
    digest.add(mesh.points.data(), mesh.points.size() * sizeof(Vec3));
    digest.add(mesh.nodes.data(), mesh.nodes.size() * sizeof(int));
    return digest.text();
}

/// On root: reads and meshes the robot.
Result<sim::Description> read(const Options& options, Job& job, RobotData& data) {
    std::vector<std::string> assignments = options.assignments;
    if (options.steps > 0) assignments.push_back(fmt::format("program.steps={}", options.steps));
    Result<robot::Robot> robot = robot::load_robot(options.robot, assignments);
    if (!robot) return tl::unexpected(robot.error());
    const Result<std::string> text = read_file(options.robot);
    if (!text) return tl::unexpected(text.error());
    const Result<std::optional<std::string>> base = robot::base_text(*text, options.robot);
    if (!base) return tl::unexpected(base.error());
    const Result<std::string> files = robot::digest_of_named_files(*text, options.robot, assignments);
    if (!files) return tl::unexpected(files.error());
    Stopwatch watch;
    Progress silent;
    Result<mesh::TetMesh> mesh = robot::build_mesh(*robot, silent);
    if (!mesh) return tl::unexpected(mesh.error());
    job = {robot->program, digest_of(*text, *base, *files, assignments, *mesh)};
    data.name = robot->name;
    Result<sim::Description> description = robot::build_description(*robot, std::move(*mesh));
    if (!description) return tl::unexpected(description.error());
    if (Status able = sim::distributed::check_able(*description, robot->program); !able)
        return input_error("{}: {}", options.robot, able.error().message);
    data.mesh = description->mesh;
    data.contact = description->contact;
    data.warnings = description->notes;
    data.mesh_s = watch.read_s();
    return description;
}

void broadcast(const Ranks& ranks, Job& job) {
    static_assert(std::is_trivially_copyable_v<sim::Program>);
    std::string bytes(sizeof job.program, '\0');
    std::memcpy(bytes.data(), &job.program, sizeof job.program);
    ranks.broadcast(bytes);
    std::memcpy(&job.program, bytes.data(), sizeof job.program);
    ranks.broadcast(job.origin);
}

/// The folder of a checkpoint that is there.
Result<CheckpointFolder> open_kept_folder(const fs::path& kept) {
    const auto is_there = [&] {
        std::error_code code;
        return fs::exists(kept / "state.h5", code);
    };
    const auto missing = [&] {
        return input_error("{}: there is no checkpoint; run without --resume to start anew", kept.string());
    };
    if (!is_there()) return missing();
    Result<CheckpointFolder> folder = CheckpointFolder::open(kept, kept_mark);
    if (folder && !is_there()) return missing();  // the job that had it has come to its end meanwhile
    return folder;
}

/// On root: the folder with frames and checkpoint during a run. A new run starts with an empty one.
Status make_kept_folder(const Options& options, const sim::Description& description, RobotData& data) {
    if (options.folder.empty()) return {};
    for (const fs::path& input : robot::files_of(options.robot, options.assignments))
        if (Status outside = check_outside(input, options.folder); !outside) return outside;
    if (Status place = check_folder_place(options.folder, report::simulation_mark()); !place) return place;
    const fs::path kept = kept_folder(options), frames = kept / kept_mark;
    Result<CheckpointFolder> folder =
        options.resume ? open_kept_folder(kept) : CheckpointFolder::create(kept, kept_mark);
    if (!folder) return tl::unexpected(folder.error());
    data.kept = std::move(*folder);
    if (options.resume) return {};
    std::error_code code;
    fs::create_directory(frames, code);
    if (code) return failure("{}: cannot be created: {}", frames.string(), code.message());
    return options.frames_every > 0 ? sim::distributed::write_frame_mesh(frames, description) : Status{};
}

std::string at_end(const Options& options, int step, int steps) {
    if (step == 0 || options.folder.empty() || options.checkpoint_every == 0)
        return "pliant-mpi: the job has been ended from outside\n";
    const int kept = step - step % options.checkpoint_every;
    if (kept == 0) return "pliant-mpi: the job has been ended from outside, before the first checkpoint\n";
    return fmt::format(
        "pliant-mpi: the job has been ended from outside; the same command with --resume goes on after step {} of {}\n",
        kept, steps);
}

/// Callbacks of a run; `frames` and `checkpoint` must outlive it.
sim::distributed::RunOptions run_options(const Ranks& ranks, const Options& options, const Job& job, Frames& frames,
                                         const Checkpoint& checkpoint) {
    sim::distributed::RunOptions run{.preconditioner = options.preconditioner};
    const int steps = job.program.steps;
    run.on_step = [&ranks, &options, &frames, steps](const sim::Step& step, const Eigen::VectorXd& x) -> Status {
        if (ranks.is_root() && !options.quiet && !options.json && step.index > 0) {
            fmt::print("step {} of {}: {} iterations, residual {:.1e}, {:.2f} s\n", step.index, steps, step.iterations,
                       step.residual, step.wall_s);
            std::fflush(stdout);
        }
        const bool drawn = options.frames_every > 0 && step.index % options.frames_every == 0;
        return drawn && !options.folder.empty() ? frames.write(step.index, x) : Status{};
    };
    run.on_checkpoint = [&ranks, &options, &checkpoint, steps](const sim::distributed::RunState& state) -> Status {
        if (options.folder.empty() || options.checkpoint_every == 0 || state.step % options.checkpoint_every != 0)
            return {};
        Status status = checkpoint.keep(state);
        if (status && ranks.is_root()) say_at_end(at_end(options, state.step, steps));
        return status;
    };
    return run;
}

double peak_memory_MB(const Ranks& ranks) {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return ranks.sum(static_cast<double>(usage.ru_maxrss) / 1024);
}

void print_work(const sim::distributed::RunResult& result, double memory_MB) {
    const sim::distributed::LinearWork &work = result.work, &rotation = result.rotation;
    fmt::print("{} matrices: {:.2f} s to assemble, {:.2f} s to set up; {} solutions, {} iterations, {:.2f} s\n",
               work.matrices, work.assemble_s, work.set_up_s, work.solutions, work.iterations, work.solve_s);
    fmt::print("rotating steps: {:.2f} s to set up; {} solutions, {} iterations, {:.2f} s; {:.0f} MB in total\n",
               rotation.set_up_s, rotation.solutions, rotation.iterations, rotation.solve_s, memory_MB);
}

/// On root: writes and prints the results.
Result<int> report_results(const Ranks& ranks, const Options& options, const Job& job, const RobotData& data,
                           sim::distributed::RunResult result, double memory_MB) {
    result.trajectory.warnings.insert(result.trajectory.warnings.begin(), data.warnings.begin(), data.warnings.end());
    report::Simulation simulation{.robot = data.name, .mesh = data.mesh, .result = result.trajectory};
    simulation.tolerance = job.program.tolerance;
    simulation.peak_memory_MB = memory_MB;
    simulation.timing.mesh_s = data.mesh_s;
    if (data.kept) {
        if (Status status = write_results(options.folder, data.kept->path(), simulation); !status)
            return tl::unexpected(status.error());
        if (Status status = data.kept->remove(); !status) return tl::unexpected(status.error());
    }
    if (options.json) {
        fmt::print("{}", report::summary_json(simulation));
    } else if (!options.quiet) {
        print_summary(simulation, ranks.count());
        print_work(result, memory_MB);
        if (!options.folder.empty()) fmt::print("results: {}, open frames.xdmf there in ParaView\n", options.folder);
    }
    for (const std::string& warning : result.trajectory.warnings)
        fmt::print(stderr, "{}: warning: {}\n", options.robot, warning);
    if (result.trajectory.converged) return exit_done;
    return failure("{}: {}", options.robot, result.trajectory.message);
}

Result<int> solve(const Ranks& ranks, const Options& options, const Job& job, RobotData data,
                  sim::Description description) {
    Result<DistributedEquilibrium> system = sim::distributed::distribute(ranks, std::move(description));
    if (!system) {
        const Error& error = system.error();
        return tl::unexpected(Error{error.cause, options.robot + ": " + error.message});
    }
    Frames frames(*system, kept_folder(options) / "frames");
    const Checkpoint checkpoint(*system, kept_folder(options), job.origin);
    const sim::distributed::SelfContactCheck self_contact(*system, data.contact);
    if (self_contact.crosses_at_rest())
        data.warnings.push_back("the robot crosses itself at rest: self-contact is not detected");
    auto run = run_options(ranks, options, job, frames, checkpoint);
    run.meets = [&self_contact](const Eigen::VectorXd& from, const Eigen::VectorXd& to) {
        return self_contact.meets(from, to);
    };
    if (options.resume) {
        Result<sim::distributed::RunState> begin = checkpoint.read(job.program);
        if (!begin) return tl::unexpected(begin.error());
        if (ranks.is_root() && !options.quiet && !options.json)
            fmt::print("resuming after step {} of {}\n", begin->step, job.program.steps);
        if (ranks.is_root()) say_at_end(at_end(options, begin->step, job.program.steps));
        run.begin = std::move(*begin);
    }
    Result<sim::distributed::RunResult> result = sim::distributed::run(*system, job.program, std::move(run));
    if (!result) return tl::unexpected(result.error());
    const double memory_MB = peak_memory_MB(ranks);
    Result<int> status = exit_done;
    const bool converged = result->trajectory.converged;
    if (ranks.is_root()) status = report_results(ranks, options, job, data, std::move(*result), memory_MB);
    if (Status all = ranks.agree(status ? Status{} : tl::unexpected(status.error())); !all)
        return tl::unexpected(all.error());
    return converged ? exit_done : exit_failed;
}

}  // namespace

Result<int> simulate(const Ranks& ranks, const Options& options) {
    if (options.resume && options.folder.empty())
        return input_error("--resume needs --output: the checkpoint is beside that folder");
    say_at_end(ranks.is_root() ? at_end(options, 0, 0) : "");
    Job job;
    RobotData data;
    sim::Description description;
    Status status{};
    if (ranks.is_root()) {
        Result<sim::Description> read_one = read(options, job, data);
        if (read_one) description = std::move(*read_one);
        status = read_one ? make_kept_folder(options, description, data) : Status(tl::unexpected(read_one.error()));
    }
    if (status = ranks.agree(status); !status) return tl::unexpected(status.error());
    broadcast(ranks, job);
    Result<int> result = exit_failed;
    // One thread per rank: mpirun and srun determine how many ranks share a machine.
    on_own_core([&] { result = solve(ranks, options, job, std::move(data), std::move(description)); });
    return result;
}

}  // namespace pliant::app
