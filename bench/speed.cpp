// The tables of docs/performance.md, made again: frames, cold starts beside CalculiX, and how time and memory grow with
// the mesh. Every case runs in a process of its own, so that its memory is its own; every row says what was reached.
//   build/release/bench/pliant_speed [frames|elements|cold|fingers|contact|size [TETS [PNG]]|huge [SHARE [CORES]]]
// all but huge, or one table; sizes up to TETS, and a plot of them on one core and on two; a share of the huge ones, on
// two or so many cores
#include <fmt/format.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <optional>
#include <string>

#include "base/core/files.hpp"
#include "base/core/stopwatch.hpp"
#include "presentation/draw/plot.hpp"
#include "problems.hpp"
#include "simulation/peers/calculix.hpp"
#include "simulation/run/simulate.hpp"

using namespace pliant;
using namespace pliant::sim;

namespace {

constexpr int repeats = 5;

/// Runs `work` in a child; false if it failed there. What it prints appears here.
bool apart(const std::function<void()>& work) {
    std::fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        work();
        std::fflush(stdout);
        std::_Exit(0);
    }
    int status = 0;
    return child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

double peak_MB() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024;
}

Trajectory solve(const Model& model, const Program& program) {
    Progress silent;
    Program solver_alone = program;
    solver_alone.checks = false;
    return run(model, solver_alone, silent);
}

/// The quickest of several runs: on a shared machine the others tell of its other users.
Trajectory quickest(const Model& model, const Program& program) {
    Trajectory best = solve(model, program);
    for (int k = 1; k < repeats; ++k) {
        Trajectory next = solve(model, program);
        if (next.setup_s + next.solve_s < best.setup_s + best.solve_s) best = std::move(next);
    }
    return best;
}

double iterations(const Trajectory& t) {
    double sum = 0;
    for (const Step& step : t.steps) sum += step.iterations;
    return sum;
}

Vec3 tip(const Trajectory& t) {
    return t.steps.back().markers[0].position_m;
}

/// Tension or pressure at the end, 0 where there is neither.
double actuation(const Trajectory& t) {
    const Step& last = t.steps.back();
    return !last.cables.empty() ? last.cables[0].tension_N : !last.chambers.empty() ? last.chambers[0].pressure_Pa : 0;
}

void frames_of(const std::string& name, Description description, Program program) {
    const auto model = Model::create(std::move(description));
    const Trajectory found = quickest(*model, program);
    const double asked = program.tolerance;
    program.tolerance = 1e-9;
    const Trajectory exact = solve(*model, program);
    if (!found.converged || !exact.converged) return fmt::print("| {} | did not converge |\n", name);
    const double frames = static_cast<double>(found.steps.size() - 1);
    const double moved = norm(tip(exact) - exact.steps.front().markers[0].position_m);
    const double wrong = actuation(exact) != 0 ? std::abs(actuation(found) / actuation(exact) - 1) : 0;
    fmt::print("| {} | {} | {:.0e} | {:.2f} | {:.1f} | {:.1e} | {:.1e} | {:.1e} | {:.0f} |\n", name,
               model->mesh().tet_count(), asked, 1e3 * found.solve_s / frames, iterations(found) / frames,
               found.steps.back().residual, norm(tip(found) - tip(exact)) / moved, wrong, peak_MB());
}

void frames() {
    fmt::print(
        "Errors are relative to the same program at a tolerance of 1e-9.\n\n"
        "| robot | tets | tolerance | ms per frame | iterations per frame | residual | tip error | force error "
        "| peak memory, MB |\n|---|---|---|---|---|---|---|---|---|\n");
    const auto row = [](const std::string& name, const std::function<Description()>& describe, double tolerance) {
        apart([&] { frames_of(name, describe(), {.steps = 20, .tolerance = tolerance}); });
    };
    for (const double tolerance : {1e-3, 1e-6})
        row(
            "bend", [] { return bench::two_material_bend(0.45, 1); }, tolerance);
    row(
        "cable, 1 % each", [] { return bench::cable_bar(1); }, 1e-4);
    row(
        "chamber", [] { return bench::air_bar(); }, 1e-4);
    row(
        "cable, 1 % each, quadratic", [] { return bench::cable_bar(2); }, 1e-4);
    row(
        "chamber, quadratic", [] { return bench::air_bar(2); }, 1e-4);
}

double processor_s() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The thesis' models, s or e changed by some 0.01 a frame. Time is that of the processor, which others on the machine
/// lengthen least; without the set-up, which is once. Error of the tip: against the same model at 1e-8.
void elements_of(const std::string& name, Description description, Solver solver, double tolerance) {
    const auto model = Model::create(std::move(description));
    Program program{.steps = 60, .tolerance = tolerance, .solver = solver};
    double best_s = 0;
    Trajectory found;
    for (int k = 0; k < 3; ++k) {
        const double start = processor_s();
        found = solve(*model, program);
        const double spent = processor_s() - start - found.setup_s;
        best_s = k == 0 ? spent : std::min(best_s, spent);
        if (!found.converged || best_s > 60) break;
    }
    if (!found.converged)
        return fmt::print("| {} | {} | {:.0e} | {} after {:.1f} s |\n", name, sim::name(solver), tolerance,
                          found.message, best_s);
    program.tolerance = 1e-8;
    program.solver = Solver::automatic;
    const Trajectory exact = solve(*model, program);
    const double moved = norm(tip(exact) - exact.steps.front().markers[0].position_m);
    const double frames = static_cast<double>(found.steps.size() - 1);
    fmt::print("| {} | {} | {} | {:.0e} | {:.1f} | {:.0f} | {:.1f} | {:.1e} |\n", name, model->mesh().tet_count(),
               sim::name(solver), tolerance, 1e3 * best_s / frames, frames / best_s, iterations(found) / frames,
               norm(tip(found) - tip(exact)) / moved);
}

void elements() {
    fmt::print(
        "| thesis' model | tets | solver | tolerance | ms per frame | frames per second | iterations per frame | ");
    fmt::print("tip error |\n|---|---|---|---|---|---|---|---|\n");
    const auto rows = [](const std::string& name, Description (*describe)()) {
        apart([&] { elements_of(name, describe(), Solver::local_global, 1e-2); });
        apart([&] { elements_of(name, describe(), Solver::anderson, 1e-2); });
        for (const double tolerance : {1e-2, 1e-3})
            apart([&] { elements_of(name, describe(), Solver::automatic, tolerance); });
    };
    rows("gap elements", bench::thesis_gap_bar);
    rows("air elements", bench::thesis_air_bar);
}

/// Pliant runs before and after CalculiX, which takes so long that the machine may change its speed meanwhile.
void cold_of(double nu) {
    const Description description = bench::two_material_bend(nu, 1);
    const auto model = Model::create(description);
    const Program program{.steps = 1, .tolerance = 1e-6};
    const Trajectory found = quickest(*model, program);
    if (!found.converged) return fmt::print("| {} | did not converge |\n", nu);
    const auto theirs =
        calculix::installed() ? calculix::solve(description) : Result<calculix::Solution>(input_error("not installed"));
    const Trajectory after = quickest(*model, program);
    const double ours = std::min(found.setup_s + found.solve_s, after.setup_s + after.solve_s);
    fmt::print("| {} | {:.1f} | {:.0f} | {:.1e} |", nu, 1e3 * ours, iterations(found), found.steps.back().residual);
    if (!theirs) return fmt::print(" - | - | - |\n");
    const Vec3 u = tip(found) - found.steps.front().markers[0].position_m;
    const Vec3 v = calculix::displacement(*theirs, description.markers[0].point);
    fmt::print(" {:.2f} | {:.0f} | {:.1e} |\n", theirs->wall_s, theirs->wall_s / ours, norm(u - v) / norm(v));
}

void cold() {
    fmt::print(
        "| nu | Pliant, ms | iterations | residual | CalculiX, s | CalculiX / Pliant | tip difference "
        "|\n|---|---|---|---|---|---|---|\n");
    for (const double nu : {0.3, 0.45, 0.49}) apart([nu] { cold_of(nu); });
}

void pull(const std::string& folder, int steps) {
    const auto model = Model::create(bench::finger_7k(folder));
    const Trajectory found = quickest(*model, {.steps = steps, .tolerance = 1e-4});
    const Trajectory exact = solve(*model, {.steps = steps, .tolerance = 1e-9});
    if (!found.converged || !exact.converged) return fmt::print("| did not converge |\n");
    const double moved = norm(tip(exact) - exact.steps.front().markers[0].position_m);
    fmt::print("| {} | {:.0f} | {:.0f} | {:.0f} | {:.1e} | {:.1e} | {:.4f} |\n", steps, 1e3 * found.setup_s,
               1e3 * found.solve_s, iterations(found), found.steps.back().residual,
               norm(tip(found) - tip(exact)) / moved, actuation(found));
}

/// From the mesh file to the first frame, pulled by 1 mm: the fastest of several runs.
void start(const std::string& folder) {
    using Clock = std::chrono::steady_clock;
    struct Times {
        double read_ms = 0, model_ms = 0, setup_ms = 0, frame_ms = 0;
        [[nodiscard]] double all() const { return read_ms + model_ms + setup_ms + frame_ms; }
    } best;
    for (int k = 0; k < repeats; ++k) {
        const auto begin = Clock::now();
        Description description = bench::finger_7k(folder);
        description.cables[0].target.value = 1e-3;
        const auto read = Clock::now();
        const auto model = Model::create(std::move(description));
        const auto made = Clock::now();
        const Trajectory found = solve(*model, {.steps = 1, .tolerance = 1e-4});
        if (!found.converged) return fmt::print("| did not converge |\n");
        const auto ms = [](auto time) { return std::chrono::duration<double, std::milli>(time).count(); };
        const Times now{ms(read - begin), ms(made - read), 1e3 * found.setup_s, 1e3 * found.solve_s};
        if (k == 0 || now.all() < best.all()) best = now;
    }
    fmt::print("| {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} |\n", best.read_ms, best.model_ms, best.setup_ms,
               best.frame_ms, best.all());
}

/// CalculiX gets the tension that Pliant finds.
void quadratic_finger(const std::string& folder) {
    const double ratio = 0.8;
    const auto model = Model::create(bench::notched_finger(folder, 2, {CableTarget::Kind::length_ratio, ratio}));
    for (const int steps : {1, 4}) {
        const Trajectory found = quickest(*model, {.steps = steps, .tolerance = 1e-5});
        if (!found.converged) return fmt::print("| did not converge: {} |\n", found.message);
        const double ours = found.setup_s + found.solve_s;
        fmt::print("| {} | {:.2f} | {:.0f} | {:.1e} | {:.3f} |", steps, ours, iterations(found),
                   found.steps.back().residual, actuation(found));
        std::fflush(stdout);
        const Description pulled = bench::notched_finger(folder, 2, {CableTarget::Kind::tension_N, actuation(found)});
        const auto theirs =
            calculix::installed() ? calculix::solve(pulled) : Result<calculix::Solution>(input_error("not installed"));
        if (!theirs) {
            fmt::print(" - | - | - |\n");
            continue;
        }
        const Vec3 u = tip(found) - found.steps.front().markers[0].position_m;
        const Vec3 v = calculix::displacement(*theirs, pulled.markers[0].point);
        fmt::print(" {:.1f} | {:.0f} | {:.1e} |\n", theirs->wall_s, theirs->wall_s / ours, norm(u - v) / norm(v));
    }
}

void fingers() {
    const char* folder = std::getenv("PLIANT_REFERENCE_DATA");
    if (folder == nullptr)
        return fmt::print("fingers: skipped; set PLIANT_REFERENCE_DATA to the folder with their meshes\n");
    fmt::print(
        "| reading the mesh, ms | model, ms | setup, ms | first frame, ms | total, ms |\n|---|---|---|---|---|\n");
    apart([&] { start(folder); });
    fmt::print(
        "| finger pulled by 40 mm, steps | setup, ms | solution, ms | iterations | residual | tip error | tension, N "
        "|\n");
    fmt::print("|---|---|---|---|---|---|---|\n");
    for (const int steps : {1, 4, 40}) apart([&] { pull(folder, steps); });
    fmt::print(
        "| quadratic finger, steps | Pliant, s | iterations | residual | tension, N | CalculiX, s | CalculiX / Pliant "
        "|");
    fmt::print(" tip difference |\n|---|---|---|---|---|---|---|---|\n");
    apart([&] { quadratic_finger(folder); });
}

/// Self-contact as a robot file's default has it.
ContactRules default_contact(const Description& d) {
    Box3 box;
    for (const Vec3& p : d.mesh.points) box.add(p);
    ContactRules rules{contact::robot_surface(d.mesh), {}, {}};
    rules.settings.distance_m = 1e-3 * box.diagonal();
    rules.settings.slip_m = 1e-2 * rules.settings.distance_m;
    rules.settings.stiffness_Pa = 1e5;
    return rules;
}

/// The same program without contact, with contact only after the robot has touched itself (the default), and with
/// contact from the start, in turns: the median time of the first, and the median ratios of the others to it.
void contact_of(const std::string& name, Description description, const Program& program) {
    const auto without = Model::create(description);
    description.contact = default_contact(description);
    const auto always = Model::create(description);
    description.contact->self_when_met = true;
    const auto waits = Model::create(std::move(description));
    std::vector<double> off, waiting, on;
    bool same = true;
    for (int k = 0; k < 3 * repeats; ++k) {
        const Trajectory a = solve(*without, program), b = solve(*waits, program), c = solve(*always, program);
        if (!a.converged || !b.converged || !c.converged) return fmt::print("| {} | did not converge |\n", name);
        off.push_back(a.solve_s);
        waiting.push_back(b.solve_s / a.solve_s);
        on.push_back(c.solve_s / a.solve_s);
        same &= tip(a) == tip(b);
    }
    const auto median = [](std::vector<double>& values) {
        std::sort(values.begin(), values.end());
        return values[values.size() / 2];
    };
    fmt::print("| {} | {} | {:.2f} | {:.2f} | {:.2f} | {} |\n", name, without->mesh().tet_count(),
               1e3 * median(off) / program.steps, median(waiting), median(on), same ? "equal" : "different");
}

/// The cost of contact where nothing touches.
void contact_price() {
    fmt::print(
        "ratio: time relative to that without contact.\n\n"
        "| robot | tets | without contact, ms per frame | contact on demand (default), ratio | contact from the start, "
        "ratio | tip without contact and by default |\n"
        "|---|---|---|---|---|---|\n");
    const auto row = [](const std::string& name, const std::function<Description()>& describe, double tolerance,
                        int steps = 20) {
        apart([&] { contact_of(name, describe(), {.steps = steps, .tolerance = tolerance}); });
    };
    row(
        "bend", [] { return bench::two_material_bend(0.45, 1); }, 1e-3);
    row(
        "cable, 1 % each", [] { return bench::cable_bar(1); }, 1e-4);
    row(
        "chamber", [] { return bench::air_bar(); }, 1e-4);
    row(
        "cable, 1 % each, quadratic", [] { return bench::cable_bar(2); }, 1e-4);
    const char* folder = std::getenv("PLIANT_REFERENCE_DATA");
    if (folder == nullptr) return;
    const auto finger = [&] {
        Description description = bench::finger_7k(folder);
        description.cables[0].target.value = 2e-2;
        return description;
    };
    row("finger, 0.5 mm each", finger, 1e-4, 40);
}

struct Cells {
    int along, across;
    [[nodiscard]] double tets() const { return 6.0 * along * across * across; }
};

struct ColdStart {
    double model_s, setup_s, solve_s, iterations, tip_z_mm, peak_MB;
    [[nodiscard]] double seconds() const { return setup_s + solve_s; }
};

/// The bend from rest, in a process of its own that has so many of this one's cores; nothing if it failed there.
std::optional<ColdStart> cold_start(const Cells& cells, int order, double tolerance, int cores) {
    int ends[2];
    if (pipe(ends) != 0) return std::nullopt;
    const bool done = apart([&] {
        cpu_set_t mine, some;
        sched_getaffinity(0, sizeof(mine), &mine);
        CPU_ZERO(&some);
        for (int cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&some) < cores; ++cpu) {
            if (CPU_ISSET(cpu, &mine)) CPU_SET(cpu, &some);
        }
        sched_setaffinity(0, sizeof(some), &some);
        sim::Description bend = bench::two_material_bend(0.45, order, cells.along, cells.across);
        Stopwatch watch;
        const auto model = Model::create(std::move(bend));
        const double model_s = watch.read_s();
        const Trajectory found = solve(*model, {.steps = 1, .tolerance = tolerance});
        const ColdStart result{model_s, found.setup_s, found.solve_s, iterations(found), 1e3 * tip(found).z, peak_MB()};
        if (!found.converged || write(ends[1], &result, sizeof(result)) != sizeof(result)) std::_Exit(1);
    });
    ColdStart result{};
    const bool received = done && read(ends[0], &result, sizeof(result)) == sizeof(result);
    close(ends[0]);
    close(ends[1]);
    return received ? std::optional(result) : std::nullopt;
}

/// Largest meshes up to `most` tets; a plot of those at 1e-4 where `picture` names a file.
void sizes(double most, const std::string& picture) {
    fmt::print(
        "| tets | tolerance | one core, s | two cores, s | one core, us per tet | iterations | tip z, mm | peak "
        "memory, "
        "MB |\n"
        "|---|---|---|---|---|---|---|---|\n");
    report::Series one{"one core", {}, false}, two{"two cores", {}, false}, even{"in proportion to tets", {}, false};
    for (const Cells& c : {Cells{48, 5}, {72, 8}, {100, 10}, {128, 13}, {160, 16}, {200, 20}, {256, 26}}) {
        if (c.tets() > most) break;
        for (const double tolerance : {1e-3, 1e-4}) {
            const auto alone = cold_start(c, 1, tolerance, 1), both = cold_start(c, 1, tolerance, 2);
            if (!alone || !both) {
                fmt::print("| {:.0f} | {:.0e} | did not converge |\n", c.tets(), tolerance);
                continue;
            }
            fmt::print("| {:.0f} | {:.0e} | {:.2f} | {:.2f} | {:.1f} | {:.0f} | {:.3f} | {:.0f} |\n", c.tets(),
                       tolerance, alone->seconds(), both->seconds(), 1e6 * alone->seconds() / c.tets(),
                       alone->iterations, alone->tip_z_mm, alone->peak_MB);
            if (tolerance != 1e-4) continue;
            one.points.push_back({c.tets(), alone->seconds()});
            two.points.push_back({c.tets(), both->seconds()});
            even.points.push_back({c.tets(), one.points.front().y * c.tets() / one.points.front().x});
        }
    }
    if (picture.empty()) return;
    const auto png = report::plot_png({.title = "Two-material bend from rest, residual 1e-4",
                                       .x_label = "linear tets",
                                       .y_label = "seconds",
                                       .series = {one, two, even},
                                       .log_x = true,
                                       .log_y = true});
    if (png && write_file(picture, *png)) return;
    fmt::print(stderr, "{} could not be written\n", picture);
}

/// What two cores and 24 GiB hold: ten million linear tets, two million quadratic ones, to 1e-3. Or a share of each, on
/// some cores.
void huge(double share, int cores) {
    struct Case {
        int order;
        Cells cells;
    };
    fmt::print(
        "| tets | order | model, s | set up, s | solve, s | us per tet | iterations | tip z, mm | peak memory, MB | B "
        "per "
        "tet |\n"
        "|---|---|---|---|---|---|---|---|---|---|\n");
    for (const Case& wanted : {Case{1, {550, 55}}, Case{2, {328, 32}}}) {
        const double along = std::cbrt(share);
        const Cells cells{static_cast<int>(wanted.cells.along * along), static_cast<int>(wanted.cells.across * along)};
        const auto found = cold_start(cells, wanted.order, 1e-3, cores);
        if (!found) {
            fmt::print("| {:.0f} | {} | did not converge, or memory ended |\n", cells.tets(), wanted.order);
            continue;
        }
        fmt::print("| {:.0f} | {} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.0f} | {:.3f} | {:.0f} | {:.0f} |\n",
                   cells.tets(), wanted.order, found->model_s, found->setup_s, found->solve_s,
                   1e6 * (found->model_s + found->seconds()) / cells.tets(), found->iterations, found->tip_z_mm,
                   found->peak_MB, 1e6 * found->peak_MB / cells.tets());
    }
}

}  // namespace

int main(int argc, char** argv) {
    const std::string only = argc > 1 ? argv[1] : "";
    if (only.empty() || only == "frames") frames();
    if (only.empty() || only == "elements") elements();
    if (only.empty() || only == "cold") cold();
    if (only.empty() || only == "fingers") fingers();
    if (only.empty() || only == "contact") contact_price();
    if (only.empty() || only == "size") sizes(argc > 2 ? std::atof(argv[2]) : 3e5, argc > 3 ? argv[3] : "");
    if (only == "huge") huge(argc > 2 ? std::atof(argv[2]) : 1, argc > 3 ? std::atoi(argv[3]) : 2);
}
