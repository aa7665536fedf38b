#include "robot/contact_file.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <set>

namespace pliant::robot {
namespace {

using config::Reader;

double read_friction(Reader& reader) {
    const double friction = reader.number("friction", 0);
    if (!(friction >= 0 && friction <= 10))
        reader.problem("friction", "is a coefficient: 0 or more, rubber has 0.5 to 1");
    return friction;
}

std::variant<mesh::Solid, SurfaceFile, PlaneSelector> read_shape(Reader& reader, const Robot& robot,
                                                                 const mesh::NamedShapes& shapes,
                                                                 config::Problems& problems) {
    const int given = int{reader.has("geometry")} + int{reader.has("surface")} + int{reader.has("plane")};
    if (given != 1) reader.problem("", "takes one of geometry (a shape), surface (a file) and plane");
    std::variant<mesh::Solid, SurfaceFile, PlaneSelector> shape = PlaneSelector{{}, {0, 0, 1}};
    if (reader.has("plane")) {
        Reader plane = reader.table("plane");
        const PlaneSelector selector{plane.vector("point"), plane.vector("normal")};
        if (plane.has("normal") && norm(selector.normal) == 0) plane.problem("normal", "must not be zero");
        plane.finish();
        shape = selector;
    } else if (reader.has("surface")) {
        std::filesystem::path path(reader.text("surface"));
        if (!path.is_absolute()) path = robot.file.parent_path() / path;
        std::error_code code;
        if (!std::filesystem::is_regular_file(path, code))
            reader.problem("surface", "there is no file " + path.string());
        shape = SurfaceFile{path};
    } else if (reader.has("geometry")) {
        shape = mesh::read_solid(*reader.raw("geometry"), reader.path() + ".geometry", shapes, problems);
    }
    for (const char* key : {"geometry", "surface", "plane"}) (void)reader.raw(key);
    return shape;
}

ContactSpec read_rules(Reader reader, const Robot& robot) {
    ContactSpec contact;
    contact.line = reader.line();
    contact.self = reader.boolean("self", true);
    contact.distance = reader.quantity("distance", Dimension::length, 0) / robot.unit_m;
    if (reader.has("distance") && !(contact.distance > 0)) reader.problem("distance", "must be above zero");
    if (reader.has("stiffness")) {
        contact.stiffness_Pa = reader.quantity("stiffness", Dimension::pressure);
        if (!(*contact.stiffness_Pa > 0)) reader.problem("stiffness", "must be above zero");
    }
    (void)reader.raw("stiffness");
    contact.friction = read_friction(reader);
    contact.slip = reader.quantity("slip", Dimension::length, 0) / robot.unit_m;
    if (reader.has("slip") && !(contact.slip > 0)) reader.problem("slip", "must be above zero");
    reader.finish();
    return contact;
}

}  // namespace

void read_contact(Reader& root, Robot& robot, const mesh::NamedShapes& shapes, config::Problems& problems) {
    const bool has_rules = root.has("contact");
    ContactSpec rules = read_rules(root.table("contact", false), robot);
    std::set<std::string> taken;
    for (Reader& reader : root.tables("obstacle")) {
        ObstacleSpec obstacle;
        obstacle.line = reader.line();
        obstacle.name = reader.text("name");
        if (!taken.insert(obstacle.name).second)
            reader.problem("name", fmt::format("there are two obstacles named \"{}\"", obstacle.name));
        obstacle.shape = read_shape(reader, robot, shapes, problems);
        obstacle.friction = read_friction(reader);
        obstacle.move = reader.vector("move", Vec3{});
        reader.finish();
        robot.obstacles.push_back(std::move(obstacle));
    }
    if (has_rules || !robot.obstacles.empty()) robot.contact = rules;
}

}  // namespace pliant::robot
