// A robot as built from its file for the page.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "presentation/scene/scene.hpp"
#include "robot/description/robot.hpp"
#include "simulation/scene/scene.hpp"
#include "studio/simulate/preview.hpp"

namespace pliant::studio {

/// Mesh order used: linear tets answer at once but are too stiff; quadratic ones are those of `pliant simulate`.
/// `automatic`: during interaction, if quadratic ones are not fast enough for it, linear ones or, as soon as it has
/// been made, a reduced model of the quadratic ones; quadratic ones as soon as the input rests.
enum class Accuracy { preview, automatic, fine };
[[nodiscard]] std::string_view name(Accuracy accuracy);
[[nodiscard]] std::optional<Accuracy> accuracy_named(std::string_view name);

/// Target of a newly built robot: rest, or, for a robot that was only changed, the target of the previous one.
enum class After { from_rest, as_before };

/// Errors as JSON: a list of {"line", "text"}; line 0 if not about a line.
[[nodiscard]] std::string problem_lines(const Error& error);

/// The text of a robot file.
struct RobotText {
    std::filesystem::path file;  ///< name in messages, and base of its relative paths
    std::string text;
    Accuracy accuracy = Accuracy::automatic;
    std::int64_t opened = 0;  ///< number of the document: the same for all texts of one robot
};

/// Everything that belongs to one robot; immutable once built.
struct Built {
    Built(RobotText source_, robot::Scene scene_, std::int64_t revision_);
    RobotText source;
    robot::Robot robot;
    sim::Model model;
    std::int64_t revision;
    view::Scene scene;
    std::unique_ptr<const Preview> preview;  ///< null: one model is used for everything
    double size_m;
    std::vector<std::string> warnings;  ///< at rest, see sim::warnings_at_rest()
};

}  // namespace pliant::studio
