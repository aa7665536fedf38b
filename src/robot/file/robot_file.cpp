#include "robot/file/robot_file.hpp"

#include <algorithm>
#include <utility>

#include "base/core/files.hpp"
#include "base/core/letters.hpp"
#include "geometry/open/open_geometry.hpp"
#include "robot/description/robot.hpp"
#include "robot/file/actuator_file.hpp"
#include "robot/file/body_file.hpp"
#include "robot/file/contact_file.hpp"
#include "robot/file/goal_file.hpp"
#include "robot/file/joint_file.hpp"
#include "robot/file/place_file.hpp"
#include "robot/file/program_file.hpp"
#include "robot/file/robot_document.hpp"
#include "robot/file/sensor_file.hpp"

namespace pliant::robot {
namespace {

namespace fs = std::filesystem;
using config::Problems;
using config::Reader;

mesh::NamedShapes read_shapes(Reader& root) {
    mesh::NamedShapes shapes;
    const config::Value* value = root.raw("shape");
    if (value == nullptr) return shapes;
    if (const auto* table = std::get_if<config::Table>(&value->data)) {
        for (const auto& [name, shape] : *table) shapes.emplace_back(name, &shape);
    } else {
        root.problem("shape", "write [shape.NAME] for each shape");
    }
    return shapes;
}

bool has_time_step(const config::Value& root) {
    const config::Value* program = entry_of(root, "program");
    return program != nullptr && entry_of(*program, "time_step") != nullptr;
}

/// Of keys, among which are names of materials and shapes, and of every `name`: a line break in one would end a comment
/// or a row of the files that it is written to.
void refuse_control_characters(const config::Value& value, const std::string& path, Problems& problems) {
    constexpr const char* refusal = "must have no line breaks or other control characters";
    if (const auto* list = std::get_if<config::Array>(&value.data)) {
        for (std::size_t k = 0; k < list->size(); ++k)
            refuse_control_characters((*list)[k], fmt::format("{}[{}]", path, k), problems);
    }
    const auto* table = std::get_if<config::Table>(&value.data);
    if (table == nullptr) return;
    for (const auto& [key, entry] : *table) {
        const std::string shown = (path.empty() ? "" : path + ".") + one_line(key);
        const auto* text = key == "name" ? std::get_if<std::string>(&entry.data) : nullptr;
        const bool is_blank = text != nullptr && trimmed(*text).empty();  // which is refused for that
        if (std::ranges::any_of(key, is_control) ||
            (text != nullptr && !is_blank && std::ranges::any_of(*text, is_control)))
            problems.add(entry.line, shown, refusal);
        refuse_control_characters(entry, shown, problems);
    }
}

Result<Robot> read_robot(config::Document given, const std::vector<std::string>& assignments) {
    Result<BasedDocument> based = on_base(std::move(given));
    if (!based) return tl::unexpected(based.error());
    config::Document& document = based->document;
    if (Status status = set_all(document, assignments); !status) return tl::unexpected(status.error());
    if (Status status = config::resolve_parameters(document); !status) return tl::unexpected(status.error());

    Problems problems(document.file.string());
    refuse_control_characters(document.root, "", problems);
    Reader root(document.root, problems);
    Robot robot;
    robot.file = document.file;
    for (const std::string& assignment : assignments) {
        if (std::string why = why_idle(document, assignment.substr(0, assignment.find('='))); !why.empty())
            robot.notes.push_back(std::move(why));
    }
    robot.name = root.text("name");
    refuse_blank(root, robot.name);
    const std::string unit = root.text("length_unit");
    if (const Result<double> factor = unit_factor(unit, Dimension::length))
        robot.unit_m = *factor;
    else if (root.has("length_unit"))
        root.problem("length_unit", factor.error().message);

    Context context{robot, problems, read_shapes(root), has_time_step(document.root)};
    read_bodies(root, context);
    read_places(root, context);
    read_actuators(root, context);
    read_contact(root, context);
    read_joints(root, context);
    read_fluid(root, context);
    read_markers(root, context);
    read_sensors(root, context);
    read_goals(root, context);
    read_program(root, context);
    // The times of goals are of the robot's own program. Where a search for goals has written its answer, and in every
    // other file that stands on the robot with a program, they are of none that runs.
    if (!based->has_other_program) check_goal_times(root, robot);
    robot.times_of_other_program = based->has_other_course && !based->sets_goal_times && !set_goal_times(assignments);
    if (robot.fixed.empty() && !root.unreadable("fixed") && !may_be_free(robot))
        root.problem("",
                     "nothing is fixed; add [[fixed]] with a box that holds one end of the robot, an [[obstacle]] to "
                     "stand on, or program.time_step for a motion in time");
    if (!root.has("parameters")) (void)root.number("parameters", 0.0);  // resolved already, but known
    root.finish();
    if (Status status = problems.status(); !status) return tl::unexpected(status.error());
    return robot;
}

/// Recognised by content, for users who pass the drawing itself.
bool is_geometry(const fs::path& file) {
    const Result<std::string> bytes = read_file(file);
    if (!bytes) return false;
    const mesh::GeometryKind kind = mesh::geometry_kind(*bytes);
    if (kind == mesh::GeometryKind::unknown) return false;
    if (kind == mesh::GeometryKind::step) return true;
    if (kind == mesh::GeometryKind::threemf) return mesh::open_geometry(file).has_value();  // any zip file may be one
    // Text-based mesh formats are excluded: a robot file with an error may look like one.
    if (bytes->starts_with("solid ") || bytes->starts_with("ply\n")) return true;
    // Any bytes could begin a binary STL: it is one if it can be read.
    return bytes->find('\0') != std::string::npos && mesh::open_geometry(file).has_value();
}

}  // namespace

Result<Robot> load_robot(const fs::path& file, const std::vector<std::string>& assignments) {
    Result<config::Document> document = config::load(file);
    if (!document && is_geometry(file))
        return input_error(
            "{}: is geometry, not a robot file; write a robot file that names it, as in geometry = \"{}\" of a "
            "[[body]]",
            file.string(), file.filename().string());
    if (!document && mesh::geometry_kind_of(file) == mesh::GeometryKind::threemf)
        return input_error("{}: is a zip archive, such as a job; a robot file is needed here", file.string());
    if (!document) return tl::unexpected(document.error());
    return read_robot(std::move(*document), assignments);
}

Result<Robot> parse_robot(std::string_view text, const fs::path& file, const std::vector<std::string>& assignments) {
    Result<config::Document> document = config::parse(text, file);
    if (!document) return tl::unexpected(document.error());
    return read_robot(std::move(*document), assignments);
}

}  // namespace pliant::robot
