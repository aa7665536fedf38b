// pliant reduce: makes a reduced-order model of a robot, and compares it with the whole robot.
#include <fmt/format.h>

#include <CLI/App.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "../usage.hpp"
#include "base/core/counted.hpp"
#include "command.hpp"
#include "inputs.hpp"
#include "output_option.hpp"
#include "pliant/reduced.hpp"
#include "printed.hpp"
#include "watched.hpp"

namespace pliant::app {
namespace {

struct ReduceOptions {
    std::string robot;
    std::string file;
    ReductionOptions reduction;
    int checks = 10;
    std::vector<std::string> assignments;
    Output output;
};

/// The worst and the mean of the checks.
struct Summary {
    std::size_t found = 0, touching = 0;
    double motion_m = 0, error_m = 0, estimated_m = 0, force_error = 0;
    double reduced_s = 0, estimate_s = 0, whole_s = 0;  ///< means
};

Summary summary_of(const std::vector<ReductionCheck>& checks) {
    Summary all;
    for (const ReductionCheck& check : checks) {
        all.touching += check.touching ? 1 : 0;
        if (!check.found || check.touching) continue;
        ++all.found;
        all.motion_m = std::max(all.motion_m, check.motion_m);
        all.error_m = std::max(all.error_m, check.error_m);
        all.estimated_m = std::max(all.estimated_m, check.estimated_m);
        all.force_error = std::max(all.force_error, check.force_error);
        all.reduced_s += check.reduced_s;
        all.estimate_s += check.estimate_s;
        all.whole_s += check.whole_s;
    }
    for (double* mean : {&all.reduced_s, &all.estimate_s, &all.whole_s})
        *mean /= static_cast<double>(std::max<std::size_t>(1, all.found));
    return all;
}

void print_reduction(const ReduceOptions& options, const ReducedModel& reduced,
                     const std::vector<ReductionCheck>& checks) {
    fmt::print("{} instead of {}, {} of {}, from {}\n", counted(reduced.mode_count(), "mode"),
               counted(reduced.whole().node_count(), "node"), counted(reduced.tet_count(), "tet"),
               reduced.whole().tet_count(), counted(reduced.sample_count(), "sample"));
    if (!checks.empty()) {
        const Summary all = summary_of(checks);
        fmt::print("{} of {} checks solved; largest motion {:.4g} mm\n", all.found, checks.size(), 1e3 * all.motion_m);
        if (all.touching > 0)
            fmt::print("in {} more the robot touches itself, which a reduced model does not know\n", all.touching);
        if (all.found > 0)
            fmt::print(
                "largest error {:.3g} mm (estimated {:.3g} mm), tensions and pressures {:.2g} %\n"
                "time of an equilibrium: {:.3g} ms, with an estimate of its error {:.3g} ms, whole robot {:.3g} ms\n",
                1e3 * all.error_m, 1e3 * all.estimated_m, 100 * all.force_error, 1e3 * all.reduced_s,
                1e3 * (all.reduced_s + all.estimate_s), 1e3 * all.whole_s);
    }
    if (!options.file.empty()) fmt::print("reduced model: {}\n", options.file);
}

void print_reduction_json(const ReduceOptions& options, const ReducedModel& reduced,
                          const std::vector<ReductionCheck>& checks) {
    using Json = nlohmann::ordered_json;
    Json inputs = Json::array(), rows = Json::array();
    for (const SteeredInput& input : reduced.inputs())
        inputs.push_back({{"name", input.name}, {"unit", input.unit}, {"low", input.low}, {"high", input.high}});
    for (const ReductionCheck& check : checks) {
        Json row{{"inputs", check.inputs}, {"found", check.found}};
        if (check.touching) row["touching"] = true;
        if (check.found)
            row.update({{"motion_m", check.motion_m},
                        {"error_m", check.error_m},
                        {"estimated_m", check.estimated_m},
                        {"force_error", check.force_error},
                        {"reduced_s", check.reduced_s},
                        {"estimate_s", check.estimate_s},
                        {"whole_s", check.whole_s}});
        rows.push_back(std::move(row));
    }
    const Json json{{"robot", options.robot},
                    {"nodes", reduced.whole().node_count()},
                    {"tets", reduced.whole().tet_count()},
                    {"modes", reduced.mode_count()},
                    {"weighted_tets", reduced.tet_count()},
                    {"samples", reduced.sample_count()},
                    {"force_error", reduced.force_error()},
                    {"inputs", std::move(inputs)},
                    {"notes", reduced.notes()},
                    {"checks", std::move(rows)}};
    print_json(json, 2);
}

Result<int> reduce(const ReduceOptions& options) {
    if (Status status = expect(FileKind::robot, options.robot); !status) return tl::unexpected(status.error());
    Status named = check_ending("-o", options.file, "a reduced model", ".reduced");
    if (named) named = check_file_places({options.file});
    if (!named) return tl::unexpected(named.error());
    auto progress = terminal_progress(options.output);
    const Watch watch = watch_of(*progress);
    const Model model = load_model(options.robot, options.assignments, watch);
    const ReducedModel reduced = pliant::reduce(model, options.reduction, watch);
    const std::vector<ReductionCheck> checks = check_reduction(reduced, options.checks, watch);
    if (!options.file.empty()) reduced.save(options.file);
    progress.reset();
    if (options.output.json)
        print_reduction_json(options, reduced, checks);
    else if (!options.output.quiet)
        print_reduction(options, reduced, checks);
    for (const std::string& note : reduced.notes()) fmt::print(stderr, "{}: note: {}\n", options.robot, note);
    const bool all = std::ranges::all_of(checks, [](const ReductionCheck& check) { return check.found; });
    return all ? exit_done : exit_failed;
}

}  // namespace

void add_reduce(CLI::App& app, int& status) {
    auto options = std::make_shared<ReduceOptions>();
    CLI::App* command =
        app.add_subcommand("reduce", "make a reduced-order model for control loops, and compare it with the robot");
    command->add_option("robot", options->robot, "robot file (TOML) with ranges of actuators")->required();
    add_output_path(*command, options->file, "file for the reduced model, .reduced");
    command
        ->add_option(
            "--samples", options->reduction.samples,
            "equilibria to learn from, with no actuation and the corners of the ranges always among them; 0: 24 "
            "for each actuator, 240 at most")
        ->check(between(0, 100000))
        ->capture_default_str();
    command
        ->add_option("--basis-error", options->reduction.basis_error,
                     "share of the motion that the modes may leave out")
        ->check(between(1e-12, 0.999))
        ->capture_default_str();
    command
        ->add_option("--force-error", options->reduction.force_error,
                     "share of the forces that the weighted tets may miss")
        ->check(between(1e-12, 0.999))
        ->capture_default_str();
    command->add_option("--modes", options->reduction.most_modes, "largest number of modes")
        ->check(between(1, 1000))
        ->capture_default_str();
    command->add_option("--checks", options->checks, "other inputs at which it is compared with the whole robot")
        ->check(between(0, 100000))
        ->capture_default_str();
    command->add_option("--set", options->assignments, "KEY=VALUE: change any key, as in cable.flexor.range=[0.8, 1]")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);
    add_output_options(*command, options->output, true);
    command->footer("Example: pliant reduce examples/inverse/trunk_helix/robot.toml -o trunk.reduced");
    on_call(*command, status, [options] { return reduce(*options); });
}

}  // namespace pliant::app
