#include "studio/search/search_session.hpp"

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/core/json.hpp"
#include "presentation/report/identified.hpp"
#include "presentation/report/inverse_tables.hpp"
#include "presentation/report/workspace_files.hpp"
#include "robot/bodies/build.hpp"
#include "robot/file/program_writer.hpp"
#include "robot/file/robot_file.hpp"
#include "simulation/identify/identify.hpp"
#include "simulation/inverse/follow.hpp"
#include "simulation/inverse/workspace.hpp"
#include "simulation/run/simulate.hpp"
#include "simulation/scene/build_goals.hpp"
#include "studio/base/dumped.hpp"
#include "studio/search/sweep.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;

/// The result of a search of this robot. `order`: of its elements; linear ones are too stiff for a result.
Json result_json(const char* kind, const Built& built, Json found) {
    return {{"kind", kind},
            {"revision", built.revision},
            {"opened", built.source.opened},
            {"order", built.model.mesh().order},
            {"found", std::move(found)}};
}

/// The waypoints as a program of the robot's own file, as `pliant inverse` writes one: `keys`, and `changes` of other
/// values. `error`: there can be none.
Json program_json(const Built& built, const sim::InverseTask& task, const sim::inverse::InverseResult& found) {
    const robot::Robot& robot = built.robot;
    std::vector<robot::ProgramPoint> points;
    for (const sim::inverse::Waypoint& at : found.waypoints) {
        robot::ProgramPoint point{at.state.time, {}};
        for (std::size_t i = 0; i < at.values.size(); ++i) point.values.emplace_back(task.inputs[i].name, at.values[i]);
        points.push_back(std::move(point));
    }
    if (points.empty()) return {{"error", "no waypoint has a state"}};
    const int steps_each = robot::steps_per_point(robot, points.size());
    const Result<robot::ProgramEntries> program = robot::program_entries(robot, built.source.file, points, steps_each);
    if (!program) return {{"error", program.error().message}};
    Json changes = Json::array({{{"key", "program.steps"}, {"value", program->steps}},
                                {{"key", "program.duration"}, {"value", program->duration}}});
    const double tolerance = robot::goal_tolerance(robot.program);
    if (tolerance < robot.program.tolerance) changes.push_back({{"key", "program.tolerance"}, {"value", tolerance}});
    return {{"keys", program->keys}, {"changes", std::move(changes)}};
}

Result<SearchResult> found_inputs(const Built& built, const sim::InverseTask& task, Progress& progress) {
    sim::StepperOptions stepping = sim::stepper_options(built.robot.program);
    stepping.tolerance = robot::goal_tolerance(built.robot.program);
    sim::Stepper stepper(built.model, stepping);
    const sim::inverse::InverseResult found = sim::inverse::follow(stepper, task, {}, progress);
    if (found.cancelled) return tl::unexpected(cancelled());
    if (found.waypoints.empty()) {
        std::string why = found.message.empty() ? "no inputs are found" : found.message;
        for (const std::string& note : found.notes) why += "; " + note;
        return failure("{}", why);
    }
    Json json =
        result_json("goal", built, parse_json(report::inverse_json({built.robot.name, built.model, task, found})));
    json["program"] = program_json(built, task, found);
    return SearchResult{dumped(json)};
}

/// The current robot with other parameters, on the page's current mesh.
sim::identify::Source source_of(const RobotText& robot, mesh::TetMesh mesh) {
    return {[robot](const std::vector<std::string>& more) {
                std::vector<std::string> all;
                if (robot.accuracy == Accuracy::preview) all.emplace_back("mesh.order=1");
                all.insert(all.end(), more.begin(), more.end());
                return robot::parse_robot(robot.text, robot.file, all);
            },
            std::move(mesh)};
}

sim::identify::JudgeOn judge_of(const std::string& name) {
    if (name.empty()) return sim::identify::JudgeOn::nothing;
    return name == "every-second" ? sim::identify::JudgeOn::every_second : sim::identify::JudgeOn::second_half;
}

Result<SearchResult> identified(const Built& built, const IdentifyOrder& order, Progress& progress) {
    const auto unknowns = sim::identify::find_unknowns(built.robot, order.unknowns);
    if (!unknowns) return tl::unexpected(unknowns.error());
    const auto measurements = sim::identify::parse_measurements(order.csv, order.file, built.model.description(),
                                                                built.robot.program, judge_of(order.judge));
    if (!measurements) return tl::unexpected(measurements.error());
    Result<mesh::TetMesh> mesh = robot::build_mesh(built.robot, progress);
    if (!mesh) return tl::unexpected(mesh.error());
    const auto found =
        sim::identify::identify(source_of(built.source, std::move(*mesh)), *unknowns, *measurements, progress);
    if (!found) return tl::unexpected(found.error());
    Json json = parse_json(sim::identify::identification_json(*found));
    for (const sim::identify::Found& one : found->found) {
        const auto text = [&](double value) { return one.unknown.shown(value); };
        json["shown"].push_back({{"start", text(one.unknown.value)},
                                 {"value", text(one.value)},
                                 {"low", one.low ? text(*one.low) : ""},
                                 {"high", one.high ? text(*one.high) : ""}});
    }
    SearchResult result;
    for (const report::NamedPlot& named : report::identified_plots(*found)) {
        Result<std::string> png = report::plot_png(named.plot);
        if (!png) return tl::unexpected(png.error());
        result.plots.push_back({named.file, std::move(*png)});
    }
    json["plots"] = result.plots.size();
    result.json = dumped(result_json("identify", built, std::move(json)));
    return result;
}

Json numbers_mm(const std::vector<Vec3>& points_m) {
    Json list = Json::array();
    for (const Vec3& p : points_m) {
        for (const double v : {p.x, p.y, p.z}) list.push_back(std::round(1e6 * v) / 1e3);  // rounded to a micrometre
    }
    return list;
}

/// The workspace of a marker: the sheets, and all positions.
Json reach_of(const report::WorkspaceReport& report, std::size_t marker) {
    const mesh::TriMesh sheets = report::workspace_surface(report.workspace, marker);
    std::vector<Vec3> all;
    for (const auto& piece : report.workspace.pieces) {
        for (const auto& sample : piece.samples)
            if (sample.found) all.push_back(sample.markers[marker]);
    }
    Json triangles = Json::array();
    for (const auto& t : sheets.triangles)
        for (const int v : t) triangles.push_back(v);
    return {{"name", report.model.description().markers[marker].name},
            {"sheet_points", numbers_mm(sheets.points)},
            {"triangles", triangles},
            {"points", numbers_mm(all)}};
}

Result<SearchResult> workspace_found(const Built& built, const sim::InverseTask& task, const WorkspaceOrder& order,
                                     Progress& progress) {
    auto found = sim::inverse::find_workspace(built.model, sim::stepper_options(built.robot.program), task,
                                              {order.side, order.between}, {}, {}, progress);
    if (!found) return tl::unexpected(found.error());
    if (found->cancelled) return tl::unexpected(cancelled());
    const report::WorkspaceReport report{built.robot.name, built.model, task, *found};
    const Json summary = parse_json(report::workspace_json(report));
    if (summary["found"] == 0) return failure("{}", sim::inverse::why_nothing_is_found(*found));
    Json reach = Json::array();
    for (std::size_t m = 0; m < built.model.description().markers.size(); ++m) reach.push_back(reach_of(report, m));
    Json json = {{"summary", summary}, {"reach", reach}, {"csv", report::workspace_csv(report)}};
    return SearchResult{dumped(result_json("workspace", built, std::move(json)))};
}

}  // namespace

class SearchSession::Watch final : public Progress {
public:
    explicit Watch(SearchSession& session) : session_(session) {}
    void advance(std::string_view stage, double fraction) override {
        const auto now = std::chrono::steady_clock::now();
        if (now - last_ < std::chrono::milliseconds(100)) return;
        last_ = now;
        session_.tell_(
            dumped({{"type", "search"}, {"kind", session_.kind_}, {"stage", stage}, {"fraction", fraction}}));
    }
    [[nodiscard]] bool cancelled() const override { return session_.cancelled_; }

private:
    SearchSession& session_;
    std::chrono::steady_clock::time_point last_{};
};

SearchSession::~SearchSession() {
    cancel();
    if (thread_.joinable()) thread_.join();
}

Status SearchSession::find_inputs(std::shared_ptr<const Built> built, sim::InverseTask task) {
    return begin("goal", [built = std::move(built), task = std::move(task)](Progress& progress) {
        return found_inputs(*built, task, progress);
    });
}

Status SearchSession::identify(std::shared_ptr<const Built> built, IdentifyOrder order) {
    return begin("identify", [built = std::move(built), order = std::move(order)](Progress& progress) {
        return identified(*built, order, progress);
    });
}

Status SearchSession::find_workspace(std::shared_ptr<const Built> built, sim::InverseTask task,
                                     const WorkspaceOrder& order) {
    return begin("workspace", [built = std::move(built), task = std::move(task), order](Progress& progress) {
        return workspace_found(*built, task, order, progress);
    });
}

Status SearchSession::sweep(std::shared_ptr<const Built> built, SweepOrder order) {
    if (Status status = check_axes(built->source, order); !status) return status;
    return begin("sweep", [built = std::move(built), order = std::move(order)](Progress& progress) {
        const Result<Sweep> found = run_sweep(built->source, order, progress);
        if (!found) return Result<SearchResult>(tl::unexpected(found.error()));
        return Result<SearchResult>(
            SearchResult{dumped(result_json("sweep", *built, parse_json(sweep_json(order, *found))))});
    });
}

Status SearchSession::run_motion(std::shared_ptr<const Built> built) {
    return begin("motion", [built = std::move(built)](Progress& progress) {
        auto motion = Motion::run(built, progress);
        if (!motion) return Result<SearchResult>(tl::unexpected(motion.error()));
        SearchResult result{dumped(result_json("motion", *built, parse_json((*motion)->json())))};
        result.motion = std::move(*motion);
        return Result<SearchResult>(std::move(result));
    });
}

Status SearchSession::begin(const char* kind, std::function<Result<SearchResult>(Progress&)> work) {
    if (running_.exchange(true)) return failure("a search is running already; cancel it first");
    if (thread_.joinable()) thread_.join();
    cancelled_ = false;
    kind_ = kind;
    thread_ = std::thread([this, work = std::move(work)] {
        Watch watch(*this);
        tell_(dumped({{"type", "search"}, {"kind", kind_}, {"stage", "begin"}, {"fraction", 0}}));
        Result<SearchResult> found = work(watch);
        std::string error;
        if (found) {
            const std::lock_guard lock(mutex_);
            result_ = std::make_shared<const SearchResult>(std::move(*found));
            ++results_;
        } else if (found.error().cause != Cause::cancelled) {
            error = found.error().message;
        }
        const std::vector<std::string> news = this->news();
        running_ = false;  // before the pages are told: they may start the next one at once
        tell_(dumped({{"type", "search"}, {"kind", kind_}, {"stage", ""}, {"fraction", 1}, {"error", error}}));
        for (const std::string& one : news) tell_(one);
    });
    return {};
}

std::shared_ptr<const SearchResult> SearchSession::result() const {
    const std::lock_guard lock(mutex_);
    return result_;
}

std::vector<std::string> SearchSession::news() const {
    const std::lock_guard lock(mutex_);
    return {dumped({{"type", "searched"}, {"result", results_}})};
}

}  // namespace pliant::studio
