#include "pliant/identify.hpp"

#include <fmt/format.h>

#include <utility>

#include "base/core/files.hpp"
#include "library/base/calls.hpp"
#include "library/simulation/data.hpp"
#include "presentation/report/identified.hpp"
#include "robot/bodies/build.hpp"
#include "robot/file/robot_document.hpp"
#include "simulation/identify/identify.hpp"

namespace pliant {
namespace {

namespace fs = std::filesystem;

sim::identify::Source source_of(const std::shared_ptr<const Robot::Data>& robot, const std::optional<Mesh>& mesh,
                                library::WatchedProgress& progress) {
    Result<mesh::TetMesh> made =
        mesh ? robot::take_mesh(robot->robot, library::tet_mesh(*mesh)) : robot::build_mesh(robot->robot, progress);
    progress.rethrow();
    return {[robot](const std::vector<std::string>& more) { return library::read_again(*robot, more); },
            library::value_of(std::move(made))};
}

std::vector<FitError> fit_errors(const std::vector<sim::identify::Errors>& errors) {
    std::vector<FitError> out;
    for (const sim::identify::Errors& one : errors) out.push_back({one.unit, one.values, one.before, one.after});
    return out;
}

sim::identify::JudgeOn judge_for(JudgeOn judge) {
    switch (judge) {
        case JudgeOn::nothing:
            return sim::identify::JudgeOn::nothing;
        case JudgeOn::every_second:
            return sim::identify::JudgeOn::every_second;
        case JudgeOn::second_half:
            return sim::identify::JudgeOn::second_half;
    }
    throw Failure(Failure::Kind::input,
                  fmt::format("rows cannot be judged on {}; take one of JudgeOn", static_cast<int>(judge)));
}

}  // namespace

struct Identification::Data {
    std::shared_ptr<const Robot::Data> robot;
    std::string measured;  ///< name of the table
    sim::identify::Identification found;
};

Measurements Measurements::load(const fs::path& file) {
    return {library::value_of(read_file(file)), file.string()};
}

Identification identify(const Robot& robot, const std::vector<std::string>& unknowns, const Measurements& measured,
                        JudgeOn judge, const std::optional<Mesh>& mesh, const Watch& watch) {
    const robot::Robot& given = robot.data().robot;
    const sim::identify::JudgeOn judge_on = judge_for(judge);
    const auto wanted = library::value_of(sim::identify::find_unknowns(given, unknowns));
    library::WatchedProgress progress(watch, "identify");
    const sim::identify::Source source = source_of(robot.shared(), mesh, progress);
    const auto start = library::value_of(source.with({}, {}));
    const auto measurements = library::value_of(sim::identify::parse_measurements(
        measured.csv, measured.file, start->model.description(), given.program, judge_on));
    auto found = sim::identify::identify(source, wanted, measurements, progress);
    progress.rethrow();
    if (!found && found.error().cause == Cause::failed)
        throw Failure(Failure::Kind::failed, robot.data().file.string() + ": " + found.error().message,
                      robot.data().file.string());
    return Identification(std::make_shared<const Identification::Data>(
        Identification::Data{robot.shared(), measured.file, library::value_of(std::move(found))}));
}

Identification::Identification(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

bool Identification::converged() const {
    return data_->found.converged;
}

std::vector<Estimate> Identification::estimates() const {
    std::vector<Estimate> out;
    for (const sim::identify::Found& one : data_->found.found)
        out.push_back({one.unknown.key, one.unknown.unit, one.unknown.value, one.value, one.low, one.high, one.at_bound,
                       one.matters});
    return out;
}

std::vector<std::vector<double>> Identification::correlation() const {
    std::vector<std::vector<double>> rows;
    for (const auto& row : data_->found.correlation.rowwise()) rows.emplace_back(row.begin(), row.end());
    return rows;
}

std::vector<Comparison> Identification::comparisons() const {
    std::vector<Comparison> out;
    for (const sim::identify::Compared& one : data_->found.values) {
        const sim::identify::Channel& channel = data_->found.channels[one.measured.channel];
        out.push_back({one.measured.line, one.measured.time, channel.column, channel.unit, one.measured.judged,
                       one.measured.value, one.before, one.after});
    }
    return out;
}

std::vector<FitError> Identification::fitted() const {
    return fit_errors(data_->found.fitted);
}
std::vector<FitError> Identification::judged() const {
    return fit_errors(data_->found.judged);
}
const std::vector<std::string>& Identification::warnings() const {
    return data_->found.warnings;
}
int Identification::trials() const {
    return data_->found.trials;
}
std::vector<std::string> Identification::changes() const {
    return sim::identify::assignments(data_->found);
}

Robot Identification::robot() const {
    Robot::Data data = *data_->robot;
    data.robot = library::value_of(library::read_again(data, changes()));
    for (std::string& found : changes()) data.changes.push_back(std::move(found));
    return Robot(std::make_shared<const Robot::Data>(std::move(data)));
}

std::string Identification::text() const {
    return sim::identify::identification_text(data_->found);
}
std::string Identification::json() const {
    return sim::identify::identification_json(data_->found);
}

void Identification::write(const fs::path& folder) const {
    const Robot::Data& robot = *data_->robot;
    robot.check_outside(folder);
    std::vector<std::string> all = robot.changes;
    for (std::string& found : changes()) all.push_back(std::move(found));
    const std::string text = fmt::format("# {} with what pliant identify found from {}\n{}",
                                         robot.file.filename().string(), fs::path(data_->measured).filename().string(),
                                         library::value_of(robot::robot_text(robot.text, robot.file, all, folder)));
    library::check(write_folder(folder, "identified.toml", [&](const fs::path& aside) -> Status {
        Status status = write_file(aside / "identified.toml", text);
        if (status) status = write_file(aside / "summary.json", json() + "\n");
        if (status) status = write_file(aside / "comparison.csv", sim::identify::comparison_csv(data_->found));
        if (!status) return status;
        for (const report::NamedPlot& named : report::identified_plots(data_->found)) {
            const Result<std::string> png = report::plot_png(named.plot);
            if (!png) return tl::unexpected(png.error());
            if (status = write_file(aside / named.file, *png); !status) return status;
        }
        return {};
    }));
}

}  // namespace pliant
