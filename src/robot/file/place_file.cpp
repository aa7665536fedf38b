#include "robot/file/place_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "base/core/text.hpp"

namespace pliant::robot {
namespace {

using config::Reader;

SphereSelector read_sphere(Reader& reader) {
    Reader sphere = reader.table("sphere");
    const SphereSelector selector{sphere.vector("center"), sphere.number("radius")};
    if (sphere.has("radius") && !(selector.radius > 0)) sphere.problem("radius", "must be above zero");
    sphere.finish();
    return selector;
}

NodeSelector read_nodes(Reader& reader) {
    NodeSelector selector;
    for (const double value : reader.numbers("nodes")) {
        if (value < 0 || value != std::floor(value) || value > 2e9)
            reader.problem("nodes", "holds a value that is not a node number");
        else
            selector.nodes.push_back(static_cast<int>(value));
    }
    return selector;
}

constexpr std::string_view selector_kinds[] = {"box", "plane", "sphere", "surface", "nodes"};

bool has_selector(const Reader& reader) {
    for (const std::string_view kind : selector_kinds) {
        if (reader.has(kind)) return true;
    }
    return false;
}

constexpr std::string_view direction_help =
    "is \"normal\" or a list such as [\"x\", \"z\"] or [[1, 1, 0]]: the directions in which the nodes are held";

/// "x", "y", "z", or a vector that is not zero.
std::optional<Vec3> direction_of(const config::Value& value) {
    if (const auto* name = std::get_if<std::string>(&value.data)) {
        if (*name == "x") return Vec3{1, 0, 0};
        if (*name == "y") return Vec3{0, 1, 0};
        if (*name == "z") return Vec3{0, 0, 1};
        return std::nullopt;
    }
    config::Problems scratch("");
    const config::Value wrapped{config::Table{{"direction", value}}, value.line};
    const Vec3 direction = Reader(wrapped, scratch).vector("direction");
    return scratch.empty() && norm(direction) > 0 ? std::optional(direction) : std::nullopt;
}

/// rotate = { angle = 90, axis = [x, y, z], center = [x, y, z] }; degrees, as in shapes.
void read_rotation(Reader& reader, FixedSpec& fixed) {
    if (!reader.has("rotate")) return (void)reader.raw("rotate");
    Reader rotate = reader.table("rotate");
    fixed.rotate_deg = rotate.number("angle");
    fixed.rotation_axis = rotate.vector("axis");
    if (rotate.has("axis") && norm(fixed.rotation_axis) == 0) rotate.problem("axis", "must not be zero");
    fixed.rotation_center = rotate.vector("center", Vec3{});
    rotate.finish();
}

/// directions = "normal" (of the plane), or a list of "x", "y", "z" and vectors.
void read_directions(Reader& reader, FixedSpec& fixed) {
    const config::Value* value = reader.raw("directions");
    if (value == nullptr) return;
    const auto* plane = std::get_if<PlaneSelector>(&fixed.selector);
    const auto* word = std::get_if<std::string>(&value->data);
    if (word != nullptr && *word == "normal") {
        if (plane == nullptr) reader.problem("directions", "\"normal\" is that of a plane; give plane = { ... }");
        if (plane != nullptr) fixed.directions = {plane->normal};
        return;
    }
    const auto* list = std::get_if<config::Array>(&value->data);
    for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
        const std::optional<Vec3> direction = direction_of((*list)[i]);
        if (!direction) return reader.problem("directions", direction_help);
        fixed.directions.push_back(*direction);
    }
    if (fixed.directions.empty()) reader.problem("directions", direction_help);
    if (reader.has("rotate"))
        reader.problem("directions",
                       "has no meaning together with rotate: a support that rotates holds all directions");
}

/// Where a support does not hold its nodes, it cannot move them either.
void check_move(Reader& reader, const FixedSpec& fixed) {
    constexpr double left_over = 1e-6;
    if (fixed.directions.empty()) return;
    std::vector<Vec3> held;  // unit vectors at right angles that span the directions
    const auto free_part = [&](Vec3 v) {
        for (const Vec3& axis : held) v -= dot(v, axis) * axis;
        return v;
    };
    for (const Vec3& direction : fixed.directions) {
        const Vec3 rest = free_part(unit(direction));
        if (norm(rest) > left_over) held.push_back(unit(rest));
    }
    const Vec3 free = free_part(fixed.move);
    if (norm(free) <= left_over * norm(fixed.move)) return;
    reader.problem("move",
                   fmt::format("moves the nodes by ({:.6g}, {:.6g}, {:.6g}) across the directions in which they "
                               "are held, where they slide freely; add this direction to directions, or leave "
                               "that part of the motion out",
                               free.x, free.y, free.z));
}

void read_support(Reader& reader, Context& context, FixedSpec& fixed) {
    fixed.selector = read_selector(reader, context);
    fixed.move = reader.vector("move", Vec3{});
    read_directions(reader, fixed);
    check_move(reader, fixed);
    read_rotation(reader, fixed);
}

void read_plate(Reader& reader, Context& context, PlateSpec& plate) {
    plate.selector = read_selector(reader, context);
}

using LoadPlace = decltype(LoadSpec::place);

/// `point` or `points`, with the `radius` that spreads each over the material.
LoadPlace read_load_points(Reader& reader, const Context& context) {
    LoadPoints place;
    if (reader.has("point")) place.points = {reader.vector("point")};
    if (reader.has("points")) place.points = reader.vectors("points");
    if (place.points.empty()) reader.problem("points", "names no point");
    place.radius = reader.quantity("radius", Dimension::length, 0) / context.robot.unit_m;
    if (!(place.radius >= 0)) reader.problem("radius", "must not be below zero");
    return place;
}

LoadPlace read_load_line(Reader& reader) {
    LoadLine place{reader.vectors("line")};
    if (place.points.size() < 2) reader.problem("line", "needs at least two points");
    for (std::size_t i = 1; i < place.points.size(); ++i) {
        if (place.points[i] == place.points[i - 1])
            reader.problem("line", fmt::format("points {} and {} are the same", i, i + 1));
    }
    return place;
}

LoadPlace read_load_selector(Reader& reader, const Context& context) {
    const bool on_nodes = reader.choice("on", {"faces", "nodes"}, "faces") == "nodes";
    const Selector selector = read_selector(reader, context);
    if (on_nodes) return LoadOnNodes{selector};
    return selector;
}

/// Exactly one of: a selector, points, a line, a plate or an object.
LoadPlace read_load_place(Reader& reader, const Context& context) {
    std::vector<std::string> given;
    if (has_selector(reader)) given.emplace_back("box, plane, sphere, surface, nodes");
    for (const char* key : {"point", "points", "line", "plate", "object"}) {
        if (reader.has(key)) given.emplace_back(key);
    }
    LoadPlace place = BoxSelector{};
    if (given.size() != 1) {
        for (const std::string_view kind : selector_kinds) (void)reader.raw(kind);
        reader.problem("", given.empty() ? std::string("names no place; add box, plane, sphere, surface, nodes, point, "
                                                       "points, line, plate or object")
                                         : "takes only one of " + join_names(given));
    } else if (has_selector(reader)) {
        place = read_load_selector(reader, context);
    } else if (reader.has("line")) {
        place = read_load_line(reader);
    } else if (reader.has("plate") || reader.has("object")) {
        const bool object = reader.has("object");
        place = LoadOnRigid{object, reader.text(object ? "object" : "plate")};
    } else {
        place = read_load_points(reader, context);
    }
    if (reader.has("radius") && !std::holds_alternative<LoadPoints>(place))
        reader.problem("radius", "spreads the force at a point; give point or points");
    const bool selects = std::holds_alternative<Selector>(place) || std::holds_alternative<LoadOnNodes>(place);
    if (reader.has("on") && !selects) reader.problem("on", "goes with box, plane, sphere, surface or nodes");
    for (const char* key : {"point", "points", "line", "plate", "object", "radius", "on"}) (void)reader.raw(key);
    return place;
}

Vec3 read_vector_of(Reader& reader, std::string_view key, Dimension dimension) {
    const auto parts = reader.quantities(key, dimension, 3);
    return {parts[0], parts[1], parts[2]};
}

void read_load(Reader& reader, Context& context, LoadSpec& load) {
    load.place = read_load_place(reader, context);
    const bool rigid = std::holds_alternative<LoadOnRigid>(load.place);
    if (reader.has("torque")) {
        load.torque_Nm = read_vector_of(reader, "torque", Dimension::torque);
        if (!rigid) reader.problem("torque", "acts on what is rigid: give plate = \"NAME\" or object = \"NAME\"");
    }
    if (reader.has("pressure")) {
        load.pressure_Pa = reader.quantity("pressure", Dimension::pressure);
        if (reader.has("force")) reader.problem("force", "give either force or pressure");
        if (!std::holds_alternative<Selector>(load.place))
            reader.problem("pressure",
                           "acts on faces: give box, plane, sphere, surface or nodes without on = \"nodes\"");
    } else if (reader.has("force") || !reader.has("torque")) {
        if (!reader.has("force"))
            reader.problem("",
                           "\"force\" is missing; it is a list such as [\"0 N\", \"0 N\", \"0.06 N\"] (or "
                           "give pressure = \"3 kPa\")");
        load.force_N = read_vector_of(reader, "force", Dimension::force);
    }
    for (const char* key : {"force", "pressure", "torque"}) (void)reader.raw(key);
}

void read_marker(Reader& reader, Context&, MarkerSpec& marker) {
    if (reader.has("box")) {
        marker.place = read_box(reader);
        if (reader.has("point")) reader.problem("point", "give either point or box");
        (void)reader.raw("point");
    } else {
        marker.place = reader.vector("point");
        (void)reader.raw("box");
    }
}

/// Principal moments of inertia per mass of a homogeneous box with these edges.
Vec3 gyration_of_box(const Vec3& size) {
    const Vec3 square{size.x * size.x, size.y * size.y, size.z * size.z};
    return {(square.y + square.z) / 12, (square.x + square.z) / 12, (square.x + square.y) / 12};
}

/// `size` of a box, or `inertia`: three principal moments; about `axes`.
void read_inertia(Reader& reader, const Context& context, MassSpec& mass) {
    if (reader.has("size") && reader.has("inertia")) reader.problem("inertia", "give either size or inertia");
    if (reader.has("size")) {
        const auto size = reader.quantities("size", Dimension::length, 3);
        for (const double edge : size) {
            if (!(edge >= 0)) reader.problem("size", "must not be below zero");
        }
        mass.inertia_kg_m2 = mass.mass_kg * gyration_of_box({size[0], size[1], size[2]});
    } else if (reader.has("inertia")) {
        mass.inertia_kg_m2 = read_vector_of(reader, "inertia", Dimension::inertia);
        const Vec3& I = mass.inertia_kg_m2;
        const double slack = 1e-9 * (I.x + I.y + I.z);
        if (!(I.x >= 0 && I.y >= 0 && I.z >= 0))
            reader.problem("inertia", "must not be below zero");
        else if (I.x > I.y + I.z + slack || I.y > I.x + I.z + slack || I.z > I.x + I.y + slack)
            reader.problem("inertia", "is not possible: each of the three moments is at most the sum of the other two");
    }
    const bool inert = reader.has("size") || reader.has("inertia");
    mass.axes = read_axes(reader);
    if (reader.has("axes") && !inert) reader.problem("axes", "have no meaning without size or inertia");
    mass.radius = reader.quantity("radius", Dimension::length, 0) / context.robot.unit_m;
    if (!(mass.radius >= 0)) reader.problem("radius", "must not be below zero");
    for (const char* key : {"size", "inertia"}) (void)reader.raw(key);
}

void read_mass(Reader& reader, Context& context, MassSpec& mass) {
    mass.point = reader.vector("point");
    mass.mass_kg = reader.quantity("mass", Dimension::mass);
    if (reader.has("mass") && !(mass.mass_kg > 0)) reader.problem("mass", "must be above zero");
    if (reader.has("center")) mass.center = reader.vector("center");
    (void)reader.raw("center");
    read_inertia(reader, context, mass);
}

}  // namespace

Selector read_selector(Reader& reader, const Context& context) {
    constexpr auto& kinds = selector_kinds;
    std::vector<std::string> given;
    for (const std::string_view kind : kinds) {
        if (reader.has(kind)) given.emplace_back(kind);
    }
    if (given.size() != 1) {
        for (const std::string& kind : given) (void)reader.raw(kind);
        reader.problem("", given.empty() ? std::string("names no place; add box, plane, sphere, surface or nodes")
                                         : "takes only one of " + join_names(given));
        return BoxSelector{};
    }
    if (given[0] == "box") return read_box(reader);
    if (given[0] == "plane") return read_plane(reader);
    if (given[0] == "sphere") return read_sphere(reader);
    if (given[0] == "surface") return SurfaceSelector{need_file(reader, "surface", reader.text("surface"), context)};
    return read_nodes(reader);
}

std::array<Vec3, 2> read_axes(Reader& reader) {
    const std::array<Vec3, 2> none{Vec3{1, 0, 0}, Vec3{0, 1, 0}};
    if (!reader.has("axes")) {
        (void)reader.raw("axes");
        return none;
    }
    const std::vector<Vec3> axes = reader.vectors("axes");
    const bool two = axes.size() == 2 && norm(axes[0]) > 0 && norm(axes[1]) > 0 &&
                     std::fabs(dot(unit(axes[0]), unit(axes[1]))) < 1e-6;
    if (two) return {unit(axes[0]), unit(axes[1])};
    reader.problem("axes", "must be two directions at right angles, as [[1, 0, 0], [0, 1, 0]]");
    return none;
}

void read_places(Reader& root, Context& context) {
    read_each(root, context, "fixed", "[[fixed]]", context.robot.fixed, read_support);
    read_each(root, context, "plate", "plates", context.robot.plates, read_plate);
    read_each(root, context, "load", "loads", context.robot.loads, read_load);
    read_each(root, context, "mass", "masses", context.robot.masses, read_mass);
}

void read_markers(Reader& root, Context& context) {
    read_each(root, context, "marker", "markers", context.robot.markers, read_marker);
}

}  // namespace pliant::robot
