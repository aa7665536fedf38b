#include "robot/file/robot_file.hpp"

#include <algorithm>
#include <utility>

#include "base/core/files.hpp"
#include "geometry/open/open_geometry.hpp"
#include "robot/description/robot.hpp"
#include "robot/file/actuator_file.hpp"
#include "robot/file/body_file.hpp"
#include "robot/file/contact_file.hpp"
#include "robot/file/goal_file.hpp"
#include "robot/file/place_file.hpp"
#include "robot/file/program_file.hpp"

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

/// The values of `from` in place of those of `into`, and beside them; as `--set` would bring them in, without lines.
void put_over(config::Table& into, config::Table from) {
    for (auto& [key, value] : from) {
        const auto is_it = [&key = key](const config::Entry& entry) { return entry.first == key; };
        const auto there = std::find_if(into.begin(), into.end(), is_it);
        if (there == into.end())
            into.emplace_back(key, std::move(value));
        else
            there->second = std::move(value);
    }
}

void forget_lines(config::Value& value) {
    value.line = 0;
    if (auto* list = std::get_if<config::Array>(&value.data)) {
        for (config::Value& entry : *list) forget_lines(entry);
    }
    if (auto* table = std::get_if<config::Table>(&value.data)) {
        for (auto& [key, entry] : *table) forget_lines(entry);
    }
}

/// robot = "FILE.toml": that robot, changed by set = ["KEY=VALUE", ...], with what [program] says here in place of what
/// it says there. Without that key the document as it is.
Result<config::Document> on_base(config::Document document) {
    Problems problems(document.file.string());
    Reader root(document.root, problems);
    if (!root.has("robot")) return document;
    const fs::path file = (document.file.parent_path() / root.text("robot")).lexically_normal();
    const std::vector<std::string> changes = root.texts("set");
    const config::Value* program = root.raw("program");
    if (program != nullptr && !std::holds_alternative<config::Table>(program->data))
        root.problem("program", "must be a table");
    root.finish();
    if (Status status = problems.status(); !status) return tl::unexpected(status.error());
    Result<config::Document> base = config::load(file);
    if (!base) return tl::unexpected(base.error());
    for (const std::string& change : changes) {
        if (Status status = config::set(*base, change); !status) return tl::unexpected(status.error());
    }
    auto& table = std::get<config::Table>(base->root.data);
    if (program == nullptr) return base;
    config::Value own = *program;
    forget_lines(own);
    const auto there =
        std::find_if(table.begin(), table.end(), [](const config::Entry& entry) { return entry.first == "program"; });
    if (there == table.end())
        table.emplace_back("program", std::move(own));
    else if (auto* theirs = std::get_if<config::Table>(&there->second.data))
        put_over(*theirs, std::get<config::Table>(std::move(own.data)));
    return base;
}

Result<Robot> read_robot(config::Document given, const std::vector<std::string>& assignments) {
    Result<config::Document> based = on_base(std::move(given));
    if (!based) return tl::unexpected(based.error());
    config::Document& document = *based;
    for (const std::string& assignment : assignments) {
        if (Status status = config::set(document, assignment); !status) return tl::unexpected(status.error());
    }
    if (Status status = config::resolve_parameters(document); !status) return tl::unexpected(status.error());

    Problems problems(document.file.string());
    Reader root(document.root, problems);
    Robot robot;
    robot.file = document.file;
    robot.name = root.text("name");
    const std::string unit = root.text("length_unit");
    if (const Result<double> factor = unit_factor(unit, Dimension::length))
        robot.unit_m = *factor;
    else if (root.has("length_unit"))
        root.problem("length_unit", factor.error().message);

    Context context{robot, problems, read_shapes(root)};
    read_bodies(root, context);
    read_places(root, context);
    read_actuators(root, context);
    read_contact(root, context);
    read_markers(root, context);
    read_goals(root, context);
    read_program(root, robot);
    root.finish();
    if (Status status = problems.status(); !status) return tl::unexpected(status.error());
    return robot;
}

/// Told by its content: people hand over the drawing itself.
bool is_geometry(const fs::path& file) {
    const Result<std::string> bytes = read_file(file);
    if (!bytes) return false;
    const mesh::GeometryKind kind = mesh::geometry_kind(*bytes);
    if (kind == mesh::GeometryKind::unknown) return false;
    if (kind == mesh::GeometryKind::step || kind == mesh::GeometryKind::threemf) return true;
    // A robot file with a slip may look like a mesh format that is plain text.
    return bytes->find('\0') != std::string::npos || bytes->starts_with("solid ") || bytes->starts_with("ply\n");
}

}  // namespace

Result<Robot> load_robot(const fs::path& file, const std::vector<std::string>& assignments) {
    Result<config::Document> document = config::load(file);
    if (!document && is_geometry(file))
        return input_error(
            "{}: is geometry, no robot file; write a robot file that names it, as in geometry = \"{}\" of a [[body]]",
            file.string(), file.filename().string());
    if (!document) return tl::unexpected(document.error());
    return read_robot(std::move(*document), assignments);
}

Result<Robot> parse_robot(std::string_view text, const fs::path& file, const std::vector<std::string>& assignments) {
    Result<config::Document> document = config::parse(text, file);
    if (!document) return tl::unexpected(document.error());
    return read_robot(std::move(*document), assignments);
}

}  // namespace pliant::robot
