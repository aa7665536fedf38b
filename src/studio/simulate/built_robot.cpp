#include "studio/simulate/built_robot.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "base/core/boxes.hpp"
#include "simulation/run/warnings.hpp"
#include "studio/base/dumped.hpp"

namespace pliant::studio {

using Json = nlohmann::json;

std::string problem_lines(const Error& error) {
    if (error.problems.empty()) return dumped(Json::array({{{"line", 0}, {"text", error.message}}}));
    Json lines = Json::array();
    for (const Diagnostic& problem : error.problems)
        lines.push_back({{"line", problem.line}, {"text", shown({"", 0, problem.key, problem.text})}});
    return dumped(lines);
}

std::string_view name(Accuracy accuracy) {
    if (accuracy == Accuracy::automatic) return "automatic";
    return accuracy == Accuracy::preview ? "preview" : "fine";
}

std::optional<Accuracy> accuracy_named(std::string_view name) {
    for (const Accuracy one : {Accuracy::preview, Accuracy::automatic, Accuracy::fine})
        if (studio::name(one) == name) return one;
    return std::nullopt;
}

Built::Built(RobotText source_, robot::Scene scene_, std::int64_t revision_)
    : source(std::move(source_)),
      robot(std::move(scene_.robot)),
      model(std::move(scene_.model)),
      revision(revision_),
      scene(robot, model),
      preview(source.accuracy == Accuracy::automatic ? Preview::of(robot, model) : nullptr),
      size_m(bounds_of(model.mesh().points).diagonal()),
      warnings(sim::warnings_at_rest(model)) {}

}  // namespace pliant::studio
