// A resumed run ends with the same bits as an uninterrupted one, wherever it was stopped.
#include "simulation/run/checkpoint.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"
#include "simulation/actuators/attach.hpp"
#include "simulation/run/step_record.hpp"
#include "simulation/run/test_problems.hpp"
#include "simulation/run/test_random_program.hpp"
#include "simulation/stepper/state_file.hpp"

using namespace pliant;
using namespace pliant::sim;
using testing::model_of;

namespace {

/// Everything except wall times.
std::string bits_of(const Trajectory& result) {
    std::string bits = result.message + result.solver;
    for (const std::string& warning : result.warnings) bits += warning + '\n';
    for (Step step : result.steps) {
        step.wall_s = 0;
        bits += step_bytes(step, {});
        if (const auto& at = step.crossing_m) bits += fmt::format("{} {} {}", at->x, at->y, at->z);
    }
    Step none;
    return bits + step_bytes(none, result.iterations);
}

Trajectory run_silently(const Model& model, const Program& program, RunOptions options = {}) {
    Progress silent;
    return run(model, program, silent, std::move(options));
}

/// Runs with a checkpoint after every step until `last` is kept, as if killed there.
void run_until(const Model& model, const Program& program, const std::filesystem::path& folder, int last) {
    auto checkpoint = Checkpoint::create(folder, "test", 1);
    REQUIRE(checkpoint);
    RunOptions options;
    options.on_checkpoint = [&](const RunState& run) -> Status {
        if (Status status = checkpoint->keep(model, run); !status) return status;
        return run.step < last ? Status{} : Status(failure("killed"));
    };
    const Trajectory result = run_silently(model, program, std::move(options));
    CHECK(result.steps.size() == static_cast<std::size_t>(last) + 1);
}

Trajectory go_on(const Model& model, const Program& program, const std::filesystem::path& folder) {
    auto resumed = Checkpoint::open(folder, "test", model, program);
    REQUIRE_MESSAGE(resumed, (resumed ? "" : resumed.error().message));
    RunOptions options;
    options.begin = std::move(resumed->run);
    return run_silently(model, program, std::move(options));
}

/// A hollow block that is blown up and bent, in time if asked for.
struct Problem {
    Model model;
    Program program;
};
Problem blown_up(int order, Solver solver = Solver::automatic) {
    Description d = testing::hollow_block(order);
    d.chambers[0].target = {ChamberTarget::Kind::pressure_Pa, 4000, {}};
    return {model_of(std::move(d)), {.steps = 8, .tolerance = 1e-6, .solver = solver}};
}

/// The same with two cables: with several constraints Newton keeps how the body yields to them.
Problem pulled_and_blown_up() {
    Description d = testing::hollow_block(1);
    d.chambers[0].target = {ChamberTarget::Kind::volume_ratio, 1.2, {}};
    const Attacher attacher(d.mesh);
    for (const double y : {0.001, 0.009}) {
        Cable cable{y < 0.005 ? "left" : "right", {}, {CableTarget::Kind::length_ratio, y < 0.005 ? 0.85 : 0.95}};
        for (const double x : {0.0, 0.01, 0.02, 0.03})
            cable.points.push_back(*attacher.carried_by_tet({x, y, 0.0095}, 1e-6));
        d.cables.push_back(std::move(cable));
    }
    return {model_of(std::move(d)), {.steps = 8, .tolerance = 1e-6}};
}

/// Problems with everything that a step has to remember.
std::vector<Problem> problems_with_a_memory() {
    std::vector<Problem> problems;
    Description in_time = testing::hollow_block(1);
    in_time.chambers[0].target = {ChamberTarget::Kind::volume_ratio, 1.3, {}};
    problems.push_back({model_of(std::move(in_time)), {.steps = 8, .duration = 0.2, .dynamics = Dynamics{{2, 1e-3}}}});

    // Every formula of steps in time, and lengths that their error decides.
    for (const Dynamics& dynamics :
         {Dynamics{{2, 1e-3}, Integrator::energy_conserving, 0},
          Dynamics{{2, 1e-3}, Integrator::energy_conserving, 2e-5}, Dynamics{{2, 0}, Integrator::bdf2, 2e-5}}) {
        Description blown = testing::hollow_block(1);
        blown.chambers[0].target = {ChamberTarget::Kind::pressure_Pa, 2000, {}};
        problems.push_back({model_of(std::move(blown)), {.steps = 8, .duration = 0.2, .dynamics = dynamics}});
    }

    Description rubbed = testing::hollow_block(1);
    ContactRules rules;
    rules.surface = contact::robot_surface(rubbed.mesh);
    rules.settings = {0.0005, 1e4, 0.3, 1e-5, true};
    rules.obstacles.push_back({{"table", contact::HalfSpace{{0, 0, -0.001}, {0, 0, 1}}, 0.3}, {0.001, 0, 0.0008}});
    rubbed.contact = std::move(rules);
    problems.push_back({model_of(std::move(rubbed)), {.steps = 8}});

    Description dragged = testing::hollow_block(2);
    dragged.chambers.clear();
    Cable cable{"cable", {}, {}};
    cable.target = {CableTarget::Kind::length_ratio, 0.9};
    cable.friction = 0.3;
    for (const double x : {0.0, 0.01, 0.02, 0.03})
        cable.points.push_back(reference::mean_of(reference::nodes_where(
            dragged.mesh, [&](Vec3 p) { return std::fabs(p.x - x) < 1e-9 && p.z > 0.01 - 1e-9; })));
    dragged.cables.push_back(std::move(cable));
    problems.push_back({model_of(std::move(dragged)), {.steps = 8}});
    problems.push_back(pulled_and_blown_up());
    return problems;
}

}  // namespace

TEST_CASE("a checkpoint keeps velocities, contact, friction and slack of cables") {
    for (const Problem& p : problems_with_a_memory()) {
        const Trajectory never_stopped = run_silently(p.model, p.program);
        REQUIRE_MESSAGE(never_stopped.converged, never_stopped.message);
        for (const int last : {1, 4, 7}) {
            CAPTURE(last);
            const pliant::test::Folder folder;
            run_until(p.model, p.program, folder / "run", last);
            CHECK(bits_of(go_on(p.model, p.program, folder / "run")) == bits_of(never_stopped));
        }
    }
}

TEST_CASE("a random program resumed after any step gives the same bits") {
    int compared = 0;
    for (unsigned seed = 1; seed <= 5; ++seed) {
        sim::test::RandomProgram made = sim::test::random_program(seed);
        made.program.steps = 5;
        const std::string program = sim::test::described(made);
        CAPTURE(program);
        const Model model = model_of(std::move(made.robot));
        const Trajectory never_stopped = run_silently(model, made.program);
        for (const int last : {1, 3}) {
            if (static_cast<int>(never_stopped.steps.size()) <= last) continue;  // it stopped before
            const pliant::test::Folder folder;
            run_until(model, made.program, folder / "run", last);
            CHECK(bits_of(go_on(model, made.program, folder / "run")) == bits_of(never_stopped));
            ++compared;
        }
    }
    CHECK(compared >= 2);
}

TEST_CASE("resuming gives the same bits with every solver, both orders and after every step") {
    for (const int order : {1, 2}) {
        for (const Solver solver : {Solver::newton, Solver::quasi_newton, Solver::anderson}) {
            CAPTURE(order);
            CAPTURE(name(solver));
            const Problem p = blown_up(order, solver);
            const std::string never_stopped = bits_of(run_silently(p.model, p.program));
            for (int last = 1; last < p.program.steps; last += order == 1 ? 1 : 3) {
                const pliant::test::Folder folder;
                run_until(p.model, p.program, folder / "run", last);
                CHECK(bits_of(go_on(p.model, p.program, folder / "run")) == never_stopped);
            }
        }
    }
}

TEST_CASE("a step from a copied state gives the same bits, whatever was solved in between") {
    for (const bool several : {false, true}) {
        CAPTURE(several);
        const Problem p = several ? pulled_and_blown_up() : blown_up(1);
        Progress silent;
        Stepper stepper(p.model, stepper_options(p.program));
        const auto step = [&](Stepper& with, RobotState& robot, double end) {
            const StepPath path{end, [&](double time) { return with.controls(robot, time); }, 1.0 / 64};
            REQUIRE(with.step(robot, path, silent).arrived);
        };
        RobotState robot = stepper.rest();
        for (const double time : {0.1, 0.2, 0.3}) step(stepper, robot, time);
        const RobotState kept = robot;
        step(stepper, robot, 0.4);
        RobotState aside = stepper.rest();
        step(stepper, aside, 0.7);
        RobotState again = kept;
        step(stepper, again, 0.4);
        CHECK(state_bytes(p.model, again) == state_bytes(p.model, robot));
        Stepper other(p.model, stepper_options(p.program));
        const std::string bytes = state_bytes(p.model, kept);
        for (std::size_t at = 0; at < bytes.size(); at += bytes.size() / 40 + 1) {
            std::string damaged = bytes;
            damaged[at] ^= 4;
            const auto refused = state_from_bytes(other, damaged);
            REQUIRE_FALSE(refused);
            CHECK(refused.error().message == "not a state that Pliant has written, or damaged");
        }
        auto stored = state_from_bytes(other, bytes);
        REQUIRE(stored);
        step(other, *stored, 0.4);
        CHECK(state_bytes(p.model, *stored) == state_bytes(p.model, robot));
    }
}

TEST_CASE("a bulky body, which is solved on levels, goes on with the same bits from a copied or a stored state") {
    // Of the linear tets one coarse level serves several matrices, so that more than the last one must be known.
    for (const int order : {1, 2}) {
        CAPTURE(order);
        const int cells = order == 1 ? 16 : 8;
        Description d;
        d.mesh =
            reference::kuhn_box({0.02, 0.02, 0.02}, cells, cells, cells, [](Vec3 c) { return c.x < 0.01 ? 0 : 1; });
        if (order == 2) d.mesh = mesh::to_quadratic(d.mesh);
        d.materials = {{"hard", material::neo_hookean(3e6, 0.45), 0}, {"soft", material::neo_hookean(1e6, 0.45), 0}};
        d.material_of_region = {0, 1};
        d.supports = {{"clamp", reference::nodes_where(d.mesh, [](Vec3 p) { return p.x < 1e-9; }), {}}};
        const auto tip = reference::nodes_where(d.mesh, [](Vec3 p) { return p.x > 0.02 - 1e-9; });
        d.loads = {{"tip", tip, std::vector<double>(tip.size(), 1.0 / static_cast<double>(tip.size())), {0, 0, 200}}};
        const Model model = model_of(std::move(d));
        const Program program{.steps = 4, .tolerance = 1e-6};
        Progress silent;
        Stepper stepper(model, stepper_options(program));
        const auto step = [&](Stepper& with, RobotState& robot, int k) {
            REQUIRE(with.step(robot, program_path(with, program, robot, k), silent).arrived);
        };
        RobotState robot = stepper.rest();
        step(stepper, robot, 1);
        step(stepper, robot, 2);
        const RobotState kept = robot;
        REQUIRE(kept.memory->rates.two_levels_);
        if (order == 1) CHECK(kept.memory->base.tangent != kept.memory->tangent);
        step(stepper, robot, 3);
        const std::string bytes = state_bytes(model, robot);
        step(stepper, robot, 4);
        RobotState again = kept;
        step(stepper, again, 3);
        CHECK(state_bytes(model, again) == bytes);
        Stepper other(model, stepper_options(program));
        auto stored = state_from_bytes(other, state_bytes(model, kept));
        REQUIRE(stored);
        step(other, *stored, 3);
        CHECK(state_bytes(model, *stored) == bytes);
    }
}

TEST_CASE("the callback gets every step as it is made, the rest state first") {
    const Problem p = blown_up(1);
    std::vector<int> seen;
    RunOptions options;
    options.on_step = [&](const Step& step) { seen.push_back(step.index); };
    const Trajectory result = run_silently(p.model, p.program, std::move(options));
    CHECK(seen == std::vector{0, 1, 2, 3, 4, 5, 6, 7, 8});
    CHECK(result.steps.size() == seen.size());
}

TEST_CASE("an invalid checkpoint, or one of another run, is refused in one line") {
    const Problem p = blown_up(1);
    const pliant::test::Folder folder;
    const auto path = folder / "run";
    const auto error_of = [&](const Model& model, const std::string& origin = "test") {
        const auto resumed = Checkpoint::open(path, origin, model, p.program);
        REQUIRE_FALSE(resumed);
        return resumed.error().message;
    };
    CHECK(error_of(p.model).find("no checkpoint is there") != std::string::npos);
    run_until(p.model, p.program, path, 2);
    CHECK(error_of(p.model, "other").find("another robot file") != std::string::npos);
    CHECK(error_of(blown_up(2).model).find("another mesh") != std::string::npos);
    const std::string steps = read_file(path / "steps").value();
    const std::string state = read_file(path / "state").value();
    REQUIRE(write_file(path / "steps", steps.substr(0, steps.size() / 2)));
    CHECK(error_of(p.model).find("shorter than it was") != std::string::npos);
    REQUIRE(write_file(path / "steps", steps + "a half-written record"));
    CHECK(Checkpoint::open(path, "test", p.model, p.program));
    for (std::size_t at = 0; at < steps.size(); at += steps.size() / 40) {
        std::string changed = steps;
        changed[at] = static_cast<char>(changed[at] ^ 4);
        REQUIRE(write_file(path / "steps", changed));
        CHECK(error_of(p.model).find("damaged") != std::string::npos);
    }
    REQUIRE(write_file(path / "steps", steps));
    for (const std::size_t size : {std::size_t{0}, std::size_t{1}, state.size() / 2, state.size() - 1}) {
        REQUIRE(write_file(path / "state", state.substr(0, size)));
        CHECK(error_of(p.model).find("damaged") != std::string::npos);
    }
    for (const std::string& nested :
         {std::string(2'000'000, '\x81'), std::string("\x9b\xff\xff\xff\xff\xff\xff\xff\xf0", 9)}) {
        REQUIRE(write_file(path / "state", nested));
        CHECK(error_of(p.model).find("damaged") != std::string::npos);
    }
    REQUIRE(write_file(folder / "notes", "mine"));
    CHECK_FALSE(Checkpoint::create(folder.path(), "test", 1));
}

TEST_CASE("a checkpoint with any byte changed is refused") {
    const Problem p = blown_up(1);
    const pliant::test::Folder folder;
    const auto path = folder / "run";
    run_until(p.model, p.program, path, 3);
    const std::string state = read_file(path / "state").value(), steps = read_file(path / "steps").value();
    sim::test::Dice dice(7);
    for (int k = 0; k < 300; ++k) {
        std::string changed = k % 2 == 0 ? state : steps;
        // Heads of values are few among the bytes of the vectors: half of the changes go to the first kilobyte.
        const std::size_t end = k % 4 < 2 ? std::min<std::size_t>(1000, changed.size()) : changed.size();
        changed[static_cast<std::size_t>(dice.up_to(static_cast<int>(end) - 1))] = static_cast<char>(dice.up_to(255));
        REQUIRE(write_file(path / "state", k % 2 == 0 ? changed : state));
        REQUIRE(write_file(path / "steps", k % 2 == 0 ? steps : changed));
        const bool same = changed == (k % 2 == 0 ? state : steps);
        CHECK(Checkpoint::open(path, "test", p.model, p.program).has_value() == same);
    }
}

TEST_CASE("the checkpoint of a run at work is neither replaced nor resumed by another, and not deleted later") {
    const Problem p = blown_up(1);
    const pliant::test::Folder folder;
    const auto path = folder / "run";
    const std::string refusal = path.string() + ": another process is at work on this checkpoint";
    const auto error_of = [](const auto& result) { return result ? std::string() : result.error().message; };
    auto checkpoint = Checkpoint::create(path, "test", 1);
    REQUIRE(checkpoint);
    RunOptions options;
    options.on_checkpoint = [&](const RunState& run) -> Status {
        if (Status status = checkpoint->keep(p.model, run); !status) return status;
        if (run.step != 3) return {};
        CHECK(error_of(Checkpoint::create(path, "other", 1)).starts_with(refusal));
        CHECK(error_of(Checkpoint::open(path, "test", p.model, p.program)).starts_with(refusal));
        return {};
    };
    CHECK(run_silently(p.model, p.program, std::move(options)).converged);
    checkpoint->release();
    {
        const auto resumed = Checkpoint::open(path, "test", p.model, p.program);
        REQUIRE_MESSAGE(resumed, (resumed ? "" : resumed.error().message));
        CHECK(resumed->run.step == p.program.steps);
        CHECK(checkpoint->remove());
        CHECK(std::filesystem::exists(path / "state"));
    }
    CHECK(checkpoint->remove());
    CHECK_FALSE(std::filesystem::exists(path));
}
