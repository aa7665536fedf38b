#include "robot/place_file.hpp"

#include <cmath>

#include "core/text.hpp"

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
        reader.problem("", given.empty() ? std::string("says nothing to hold; add box, plane, sphere, surface or nodes")
                                         : "takes only one of " + join_names(given));
        return BoxSelector{};
    }
    if (given[0] == "box") return read_box(reader);
    if (given[0] == "plane") return read_plane(reader);
    if (given[0] == "sphere") return read_sphere(reader);
    if (given[0] == "surface") return SurfaceSelector{need_file(reader, "surface", reader.text("surface"), context)};
    return read_nodes(reader);
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

void read_support(Reader& reader, Context& context, FixedSpec& fixed) {
    fixed.selector = read_selector(reader, context);
    fixed.move = reader.vector("move", Vec3{});
    read_rotation(reader, fixed);
}

void read_plate(Reader& reader, Context& context, PlateSpec& plate) {
    plate.selector = read_selector(reader, context);
}

void read_load(Reader& reader, Context&, LoadSpec& load) {
    load.box = read_box(reader);
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

}  // namespace

void read_places(Reader& root, Context& context) {
    read_each(root, context, "fixed", "[[fixed]]", context.robot.fixed, read_support);
    if (context.robot.fixed.empty())
        root.problem("", "nothing is fixed; add [[fixed]] with a box that holds one end of the robot");
    read_each(root, context, "plate", "plates", context.robot.plates, read_plate);
    read_each(root, context, "load", "loads", context.robot.loads, read_load);
}

void read_markers(Reader& root, Context& context) {
    read_each(root, context, "marker", "markers", context.robot.markers, read_marker);
}

}  // namespace pliant::robot
