#include "studio/search/motion.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "simulation/run/simulate.hpp"
#include "studio/base/dumped.hpp"
#include "studio/simulate/state_json.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;

}  // namespace

Result<std::shared_ptr<const Motion>> Motion::run(std::shared_ptr<const Built> built, Progress& progress) {
    sim::Trajectory trajectory = sim::run(built->model, built->robot.program, progress);
    if (progress.cancelled()) return tl::unexpected(cancelled());
    if (trajectory.steps.size() < 2) return failure("{}", trajectory.message);
    return std::shared_ptr<const Motion>(new Motion(std::move(built), std::move(trajectory)));
}

std::string Motion::json() const {
    return dumped({{"steps", count()},
                   {"duration", built_->robot.program.duration},
                   {"timed", built_->robot.program.dynamics.has_value()},
                   {"message", trajectory_.converged ? "" : trajectory_.message},
                   {"warnings", trajectory_.warnings}});
}

std::string Motion::frame(std::size_t k, const std::set<std::string>& fields) const {
    const sim::Step& step = trajectory_.steps[k];
    Json head = state_json(step);
    head["type"] = "frame";
    head["revision"] = built_->revision;
    head["sequence"] = k;
    head["tag"] = 0;
    head["order"] = built_->model.mesh().order;
    head["refining"] = false;
    head["arrived"] = step.converged;
    head["stuck"] = step.reason;
    head["warnings"] = Json::array();
    head["playing"] = false;
    head["iterations"] = step.iterations;
    head["solve_ms"] = 1e3 * step.wall_s;
    head["wanted"] = {{"time", step.time}, {"actuators", Json::array()}};
    std::string text = dumped(head);
    text.insert(text.size() - 1,
                fmt::format(R"(,"obstacles":{})", built_->scene.obstacle_offsets(step.time, step.positions)));
    return built_->scene.frame(step, fields, text);
}

}  // namespace pliant::studio
