#include "robot/reading.hpp"

#include <fmt/format.h>

namespace pliant::robot {

using config::Reader;

std::string read_name(Reader& reader, std::set<std::string>& taken, std::string_view kind) {
    const std::string name = reader.text("name");
    if (name.empty()) return name;
    if (!taken.insert(name).second) reader.problem("name", fmt::format("there are two {} named \"{}\"", kind, name));
    return name;
}

std::filesystem::path need_file(Reader& reader, std::string_view key, const std::string& file, const Context& context) {
    std::filesystem::path path(file);
    if (!path.is_absolute()) path = context.robot.file.parent_path() / path;
    std::error_code code;
    if (!std::filesystem::is_regular_file(path, code)) reader.problem(key, "there is no file " + path.string());
    return path;
}

BoxSelector read_box(Reader& reader) {
    const auto corners = reader.vectors("box");
    if (corners.size() != 2) {
        if (reader.has("box")) reader.problem("box", "needs two corners [[x, y, z], [x, y, z]]");
        return {};
    }
    const auto& [a, b] = std::pair(corners[0], corners[1]);
    if (a.x > b.x || a.y > b.y || a.z > b.z)
        reader.problem("box", "the first corner must be the lower one on every axis");
    return {a, b};
}

PlaneSelector read_plane(Reader& reader) {
    Reader plane = reader.table("plane");
    const PlaneSelector selector{plane.vector("point"), plane.vector("normal")};
    if (plane.has("normal") && norm(selector.normal) == 0) plane.problem("normal", "must not be zero");
    plane.finish();
    return selector;
}

mesh::Solid read_shape(Reader& reader, Context& context) {
    return mesh::read_solid(*reader.raw("geometry"), reader.path() + ".geometry", context.shapes, context.problems);
}

}  // namespace pliant::robot
