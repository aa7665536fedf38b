#include "robot/file/sensor_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/core/text.hpp"
#include "robot/file/place_file.hpp"

namespace pliant::robot {
namespace {

using config::Reader;

std::vector<Vec3> read_line(Reader& reader, std::size_t least) {
    std::vector<Vec3> points = reader.vectors("points");
    if (reader.has("points") && points.size() < least)
        reader.problem("points", fmt::format("needs at least {} points", least));
    for (std::size_t i = 1; i < points.size(); ++i) {
        if (points[i] == points[i - 1])
            reader.problem("points", fmt::format("points {} and {} are the same", i, i + 1));
    }
    return points;
}

double read_radius(Reader& reader, const Context& context) {
    const double radius = reader.quantity("radius", Dimension::length, 0) / context.robot.unit_m;
    if (!(radius >= 0)) reader.problem("radius", "must not be below zero");
    return radius;
}

/// The index of the thing named by `key`; the problem message lists those that exist.
template <class Thing>
std::optional<std::size_t> read_thing(Reader& reader, std::string_view key, const std::vector<Thing>& things) {
    const std::string name = reader.text(key);
    if (!reader.has(key)) return std::nullopt;
    std::vector<std::string> names;
    for (std::size_t k = 0; k < things.size(); ++k) {
        if (things[k].name == name) return k;
        names.push_back("\"" + things[k].name + "\"");
    }
    reader.problem(
        key, fmt::format("there is no {} \"{}\"{}", key, name, names.empty() ? "" : "; there is " + join_names(names)));
    return std::nullopt;
}

ActuatorSensorSpec read_actuator(Reader& reader, const Context& context, ActuatorSensorSpec::Kind kind) {
    using Kind = ActuatorSensorSpec::Kind;
    const auto index = kind == Kind::tension ? read_thing(reader, "cable", context.robot.cables)
                                             : read_thing(reader, "chamber", context.robot.chambers);
    return {kind, index.value_or(0)};
}

bool is_named(const std::string& name, const Robot& robot) {
    const auto has = [&](const auto& things) {
        return std::ranges::any_of(things, [&](const auto& thing) { return thing.name == name; });
    };
    return has(robot.markers) || has(robot.objects);
}

/// Two `points`, or `between` two names of markers or objects.
DistanceSensorSpec read_distance(Reader& reader, const Context& context) {
    DistanceSensorSpec sensor;
    if (reader.has("points") == reader.has("between")) {
        reader.problem("", "takes one of points (two) and between (two names of markers or objects)");
    } else if (reader.has("points")) {
        const std::vector<Vec3> points = reader.vectors("points");
        if (points.size() != 2) reader.problem("points", "a distance is between two points");
        if (points.size() == 2) sensor.ends = {points[0], points[1]};
    } else {
        const std::vector<std::string> names = reader.texts("between");
        if (names.size() != 2) reader.problem("between", "a distance is between two things");
        for (std::size_t k = 0; k < std::min<std::size_t>(names.size(), 2); ++k) {
            if (!is_named(names[k], context.robot))
                reader.problem("between", fmt::format("there is no marker and no object \"{}\"", names[k]));
            sensor.ends[k] = names[k];
        }
    }
    for (const char* key : {"points", "between"}) (void)reader.raw(key);
    return sensor;
}

/// At a `point`, at a `marker`, or on an `object`.
MotionSensorSpec read_motion_sensor(Reader& reader, const Context& context) {
    MotionSensorSpec sensor;
    const int given = int{reader.has("point")} + int{reader.has("marker")} + int{reader.has("object")};
    if (given != 1) {
        reader.problem("", "takes one of point, marker and object");
    } else if (reader.has("point")) {
        sensor.place = reader.vector("point");
    } else if (reader.has("object")) {
        if (const auto index = read_thing(reader, "object", context.robot.objects))
            sensor.place = context.robot.objects[*index].name;
    } else if (const auto index = read_thing(reader, "marker", context.robot.markers)) {
        const auto* point = std::get_if<Vec3>(&context.robot.markers[*index].place);
        if (point == nullptr) reader.problem("marker", "is the mean of a box; a sensor needs a point");
        if (point != nullptr) sensor.place = *point;
    }
    sensor.axes = read_axes(reader);
    sensor.radius = read_radius(reader, context);
    for (const char* key : {"point", "marker", "object"}) (void)reader.raw(key);
    return sensor;
}

void read_sensor(Reader& reader, Context& context, SensorSpec& sensor) {
    const std::string kind =
        reader.choice("kind", {"strain", "backbone", "contact", "tension", "volume", "pressure", "distance", "motion"});
    if (reader.unreadable("kind")) {
        skip_keys(reader);
    } else if (kind == "strain") {
        sensor.what = StrainSensorSpec{read_line(reader, 2)};
    } else if (kind == "backbone") {
        BackboneSensorSpec backbone{read_line(reader, 3)};
        backbone.radius = read_radius(reader, context);
        sensor.what = std::move(backbone);
    } else if (kind == "contact") {
        sensor.what = ContactSensorSpec{read_selector(reader, context)};
    } else if (kind == "tension") {
        sensor.what = read_actuator(reader, context, ActuatorSensorSpec::Kind::tension);
    } else if (kind == "volume") {
        sensor.what = read_actuator(reader, context, ActuatorSensorSpec::Kind::volume);
    } else if (kind == "pressure") {
        sensor.what = read_actuator(reader, context, ActuatorSensorSpec::Kind::pressure);
    } else if (kind == "distance") {
        sensor.what = read_distance(reader, context);
    } else if (kind == "motion") {
        sensor.what = read_motion_sensor(reader, context);
    }
}

}  // namespace

void read_sensors(Reader& root, Context& context) {
    read_each(root, context, "sensor", "sensors", context.robot.sensors, read_sensor);
}

}  // namespace pliant::robot
