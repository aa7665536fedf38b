#include "robot/file/reading.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace pliant::robot {

using config::Reader;

bool refuse_blank(Reader& reader, const std::string& name) {
    const bool blank = name.find_first_not_of(" \t\r\n") == std::string::npos;
    if (blank) reader.problem("name", "is blank; a name is required");
    return blank;
}

std::string read_name(Reader& reader, std::set<std::string>& taken, std::string_view kind) {
    const std::string name = reader.text("name");
    if (refuse_blank(reader, name)) return name;
    if (!taken.insert(name).second) reader.problem("name", fmt::format("there are two {} named \"{}\"", kind, name));
    return name;
}

std::filesystem::path need_file(Reader& reader, std::string_view key, const std::string& file, const Context& context) {
    std::filesystem::path path(file);
    if (!path.is_absolute()) path = context.robot.file.parent_path() / path;
    std::error_code code;
    const std::filesystem::file_status status = std::filesystem::status(path, code);
    if (std::filesystem::is_directory(status))
        reader.problem(key, path.string() + " is a folder, a file is needed");
    else if (!std::filesystem::exists(status))
        reader.problem(key, "there is no file " + path.string());
    else if (!std::filesystem::is_regular_file(status))
        reader.problem(key, path.string() + " is not a regular file");
    return path;
}

void check_needs_time(Reader& reader, std::string_view key, bool is_used, const Context& context) {
    if (is_used && !context.moves_in_time) reader.problem(key, "has no meaning without program.time_step");
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

Vec3 direction_along(const Vec3& vector) {
    // The largest component comes to 1 first: squares of huge or tiny numbers are no numbers.
    const double largest = std::max({std::fabs(vector.x), std::fabs(vector.y), std::fabs(vector.z)});
    if (!(largest > 0)) return {};
    return unit(Vec3{vector.x / largest, vector.y / largest, vector.z / largest});
}

PlaneSelector read_plane(Reader& reader) {
    Reader plane = reader.table("plane");
    PlaneSelector selector{plane.vector("point"), plane.vector("normal")};
    if (plane.has("normal") && selector.normal == Vec3{}) plane.problem("normal", "must not be zero");
    if (!std::isnormal(dot(selector.normal, selector.normal))) selector.normal = direction_along(selector.normal);
    plane.finish();
    return selector;
}

namespace {

/// move = [x, y, z] and rotate = { angle = 90, axis = [x, y, z], center = [x, y, z] }; degrees.
mesh::RigidMotion read_motion(Reader& reader) {
    mesh::RigidMotion motion;
    motion.shift = reader.vector("move", Vec3{});
    if (!reader.has("rotate")) return (void)reader.raw("rotate"), motion;
    Reader rotate = reader.table("rotate");
    motion.angle_rad = rotate.number("angle") * std::numbers::pi / 180;
    motion.axis = rotate.vector("axis");
    if (norm(motion.axis) == 0) {
        rotate.problem("axis", "must not be zero");
        motion.axis = {0, 0, 1};
    }
    motion.center = rotate.vector("center", Vec3{});
    rotate.finish();
    return motion;
}

void read_mirror(Reader& place, mesh::Placement& placement) {
    if (!place.has("mirror")) return (void)place.raw("mirror");
    Reader mirror = place.table("mirror");
    placement.mirror_normal = mirror.vector("normal");
    placement.mirror_point = mirror.vector("point", Vec3{});
    if (mirror.has("normal") && norm(placement.mirror_normal) == 0) mirror.problem("normal", "must not be zero");
    mirror.finish();
}

void read_copies(Reader& place, mesh::Placement& placement) {
    constexpr std::int64_t most_copies = 1000;
    if (!place.has("repeat")) return (void)place.raw("repeat");
    Reader repeat = place.table("repeat");
    const std::int64_t count = repeat.integer("count");
    if (repeat.has("count") && (count < 1 || count > most_copies))
        repeat.problem("count", fmt::format("{} copies; 1 to {} are possible", count, most_copies));
    placement.count = static_cast<int>(std::clamp<std::int64_t>(count, 1, most_copies));
    placement.step = read_motion(repeat);
    const bool still = placement.step.angle_rad == 0 && norm(placement.step.shift) == 0;
    if (still && !repeat.unreadable("move") && !repeat.unreadable("rotate"))
        repeat.problem("", "needs move or rotate: from each copy to the next");
    repeat.finish();
}

}  // namespace

mesh::Placement read_placement(Reader& reader, std::string_view key) {
    mesh::Placement placement;
    if (!reader.has(key)) return (void)reader.raw(key), placement;
    Reader place = reader.table(key);
    placement.scale = place.number("scale", 1);
    if (!(placement.scale > 0 && placement.scale <= 1e6)) {
        place.problem("scale", "must be above zero and at most a million");
        placement.scale = 1;
    }
    read_mirror(place, placement);
    placement.motion = read_motion(place);
    read_copies(place, placement);
    place.finish();
    return placement;
}

void skip_keys(Reader& reader) {
    for (const std::string& key : reader.keys()) (void)reader.raw(key);
}

mesh::Solid read_shape(Reader& reader, Context& context) {
    return mesh::read_solid(*reader.raw("geometry"), reader.path() + ".geometry", context.shapes, context.problems);
}

}  // namespace pliant::robot
