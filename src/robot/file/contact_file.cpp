#include "robot/file/contact_file.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace pliant::robot {
namespace {

using config::Reader;

double read_friction(Reader& reader) {
    const double friction = reader.number("friction", 0);
    if (!(friction >= 0 && friction <= 10))
        reader.problem("friction",
                       fmt::format("{} is not possible; a coefficient from 0 to 10, rubber has 0.5 to 1", friction));
    return friction;
}

std::variant<mesh::Solid, SurfaceFile, PlaneSelector> read_obstacle_shape(Reader& reader, Context& context) {
    const int given = int{reader.has("geometry")} + int{reader.has("surface")} + int{reader.has("plane")};
    if (given != 1) reader.problem("", "takes one of geometry (a shape), surface (a file) and plane");
    std::variant<mesh::Solid, SurfaceFile, PlaneSelector> shape = PlaneSelector{{}, {0, 0, 1}};
    if (reader.has("plane")) {
        shape = read_plane(reader);
    } else if (reader.has("surface")) {
        shape = SurfaceFile{need_file(reader, "surface", reader.text("surface"), context), "",
                            read_placement(reader, "place")};
    } else if (reader.has("geometry")) {
        shape = read_shape(reader, context);
    }
    for (const char* key : {"geometry", "surface", "plane"}) (void)reader.raw(key);
    return shape;
}

void read_obstacle(Reader& reader, Context& context, ObstacleSpec& obstacle) {
    obstacle.shape = read_obstacle_shape(reader, context);
    obstacle.friction = read_friction(reader);
    obstacle.move = reader.vector("move", Vec3{});
}

std::variant<mesh::Solid, SurfaceFile> read_object_shape(Reader& reader, Context& context) {
    const bool drawn = reader.has("geometry");
    if (drawn == reader.has("surface")) reader.problem("", "takes one of geometry (a shape) and surface (a file)");
    std::variant<mesh::Solid, SurfaceFile> shape = SurfaceFile{};
    if (drawn)
        shape = read_shape(reader, context);
    else if (reader.has("surface"))
        shape = SurfaceFile{need_file(reader, "surface", reader.text("surface"), context)};
    for (const char* key : {"geometry", "surface"}) (void)reader.raw(key);
    return shape;
}

/// Reads mass or density; the other one is 0.
void read_mass_or_density(Reader& reader, ObjectSpec& object) {
    object.density_kg_m3 = reader.quantity("density", Dimension::density, 0);
    object.mass_kg = reader.quantity("mass", Dimension::mass, 0);
    if (reader.has("density") == reader.has("mass")) return reader.problem("", "takes one of density and mass");
    const char* key = reader.has("mass") ? "mass" : "density";
    if (!(std::max(object.density_kg_m3, object.mass_kg) > 0)) reader.problem(key, "must be above zero");
}

void read_object(Reader& reader, Context& context, ObjectSpec& object) {
    object.shape = read_object_shape(reader, context);
    object.placement = read_placement(reader, "place");
    read_mass_or_density(reader, object);
    object.velocity_m_s = reader.vector("velocity", Vec3{});
    object.angular_velocity_rad_s = reader.vector("angular_velocity", Vec3{});
    check_needs_time(reader, "velocity", object.velocity_m_s != Vec3{}, context);
    check_needs_time(reader, "angular_velocity", object.angular_velocity_rad_s != Vec3{}, context);
    object.friction = read_friction(reader);
}

FluidSpec read_fluid_table(Reader reader, const Context& context) {
    FluidSpec fluid;
    fluid.line = reader.line();
    fluid.density_kg_m3 = reader.quantity("density", Dimension::density);
    if (reader.has("density") && !(fluid.density_kg_m3 > 0)) reader.problem("density", "must be above zero");
    for (const auto& [key, drag] :
         {std::pair{"drag_normal", &fluid.drag_normal}, std::pair{"drag_tangential", &fluid.drag_tangential}}) {
        *drag = reader.number(key, 0);
        if (!(*drag >= 0 && *drag <= 1000))
            reader.problem(key,
                           fmt::format("{} is not possible; a coefficient from 0 to 1000, a plate has about 1", *drag));
        else
            check_needs_time(reader, key, *drag > 0, context);
    }
    if (reader.has("level")) fluid.level = reader.number("level");
    (void)reader.raw("level");
    fluid.current_m_s = reader.vector("current", Vec3{});
    check_needs_time(reader, "current", fluid.current_m_s != Vec3{}, context);
    reader.finish();
    return fluid;
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

void read_contact(Reader& root, Context& context) {
    const bool has_rules = root.has("contact");
    Robot& robot = context.robot;
    const ContactSpec rules = read_rules(root.table("contact", false), robot);
    read_each(root, context, "obstacle", "obstacles", robot.obstacles, read_obstacle);
    read_each(root, context, "object", "objects", robot.objects, read_object);
    if (has_rules || !robot.obstacles.empty() || !robot.objects.empty()) robot.contact = rules;
}

void read_fluid(Reader& root, Context& context) {
    const bool given = root.has("fluid");
    const Reader reader = root.table("fluid", false);
    if (given) context.robot.fluid = read_fluid_table(reader, context);
}

}  // namespace pliant::robot
