#include "robot/file/place_file.hpp"

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
            reader.problem("nodes", "holds a value that is no node number");
        else
            selector.nodes.push_back(static_cast<int>(value));
    }
    return selector;
}

Selector read_selector(Reader& reader, const Context& context) {
    constexpr std::string_view kinds[] = {"box", "plane", "sphere", "surface", "nodes"};
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
        reader.problem("directions", "has no meaning beside rotate: a support that rotates holds all directions");
}

void read_support(Reader& reader, Context& context, FixedSpec& fixed) {
    fixed.selector = read_selector(reader, context);
    fixed.move = reader.vector("move", Vec3{});
    read_directions(reader, fixed);
    read_rotation(reader, fixed);
}

void read_plate(Reader& reader, Context& context, PlateSpec& plate) {
    plate.selector = read_selector(reader, context);
}

void read_load(Reader& reader, Context& context, LoadSpec& load) {
    load.selector = read_selector(reader, context);
    if (reader.has("pressure")) {
        load.pressure_Pa = reader.quantity("pressure", Dimension::pressure);
        if (reader.has("force")) reader.problem("force", "give either force or pressure");
        (void)reader.raw("force");
    } else {
        const auto force = reader.quantities("force", Dimension::force, 3);
        if (!reader.has("force"))
            reader.problem("",
                           "\"force\" is missing; it is a list such as [\"0 N\", \"0 N\", \"0.06 N\"] (or "
                           "give pressure = \"3 kPa\")");
        load.force_N = {force[0], force[1], force[2]};
        (void)reader.raw("pressure");
    }
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

void read_mass(Reader& reader, Context&, MassSpec& mass) {
    mass.point = reader.vector("point");
    mass.mass_kg = reader.quantity("mass", Dimension::mass);
    if (reader.has("mass") && !(mass.mass_kg > 0)) reader.problem("mass", "must be above zero");
}

}  // namespace

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
