#include "simulation/identify/channel.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "simulation/gradient/objective.hpp"
#include "simulation/run/result_columns.hpp"
#include "simulation/run/sensors.hpp"

namespace pliant::sim::identify {
namespace {

using MeasureKind = sim::Measure::Kind;
using Eigen::Vector3d;

constexpr std::array<std::string_view, 3> axes = {"x", "y", "z"};

Vec3 axis_vector(std::size_t axis) {
    Vec3 v;
    v[axis] = 1;
    return v;
}

struct One {
    MeasureKind kind;
    std::string_view name, unit;  ///< of the column, after the name of the thing
    double factor;
};

template <class Things, std::size_t N>
void add_each(const Things& things, const std::array<One, N>& measures, std::vector<Channel>& all) {
    for (std::size_t k = 0; k < things.size(); ++k) {
        for (const One& one : measures) {
            const std::string unit = one.unit.empty() ? "" : fmt::format("_{}", one.unit);
            all.push_back({fmt::format("{}_{}{}", things[k].name, one.name, unit),
                           std::string(one.unit),
                           one.factor,
                           Channel::Kind::plain,
                           {{one.kind, k}}});
        }
    }
}

void add_along_axes(MeasureKind kind, std::size_t index, const std::string& name, const std::string& unit,
                    double factor, std::vector<Channel>& all) {
    for (std::size_t axis = 0; axis < 3; ++axis)
        all.push_back({fmt::format("{}_{}_{}", name, axes[axis], unit),
                       unit,
                       factor,
                       Channel::Kind::plain,
                       {{kind, index, axis_vector(axis)}}});
}

Vector3d point(std::span<const double> values, std::size_t k) {
    return {values[3 * k], values[3 * k + 1], values[3 * k + 2]};
}

/// The angle between two vectors, rad, and its derivatives with respect to both.
struct Angle {
    double value = 0;
    Vector3d by_a = Vector3d::Zero(), by_b = Vector3d::Zero();
};

Angle angle_between(const Vector3d& a, const Vector3d& b) {
    const Vector3d normal = a.cross(b);
    const double sine = normal.norm();
    Angle angle;
    angle.value = std::atan2(sine, a.dot(b));
    if (!(sine > 1e-12 * a.norm() * b.norm())) return angle;
    angle.by_a = a.cross(normal) / (sine * a.squaredNorm());
    angle.by_b = normal.cross(b) / (sine * b.squaredNorm());
    return angle;
}

/// The markers in "A-B-C", each another one, whose names may contain hyphens themselves; empty: no match.
std::vector<std::size_t> markers_in(const std::vector<sim::Marker>& markers, std::string_view text, std::size_t count) {
    for (std::size_t m = 0; m < markers.size(); ++m) {
        const std::string& name = markers[m].name;
        if (count == 1 && text == name) return {m};
        if (count == 1 || !text.starts_with(name + "-")) continue;
        std::vector<std::size_t> rest = markers_in(markers, text.substr(name.size() + 1), count - 1);
        if (rest.empty() || std::ranges::find(rest, m) != rest.end()) continue;
        rest.insert(rest.begin(), m);
        return rest;
    }
    return {};
}

Channel angle_channel(std::string_view column, Channel::Kind kind, const std::vector<std::size_t>& markers) {
    Channel channel{std::string(column), "deg", 180 / std::numbers::pi, kind, {}};
    for (const std::size_t marker : markers) {
        for (const sim::Measure& measure : sim::along_axes({MeasureKind::marker, marker}))
            channel.measures.push_back(measure);
    }
    return channel;
}

std::optional<Channel> find_angle(const sim::Description& robot, std::string_view column) {
    constexpr std::string_view ending = "_angle_deg";
    if (column.ends_with(ending)) {
        const auto markers = markers_in(robot.markers, column.substr(0, column.size() - ending.size()), 3);
        if (markers.empty()) return std::nullopt;
        return angle_channel(column, Channel::Kind::between, markers);
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::string end = fmt::format("_angle_{}_deg", axes[axis]);
        if (!column.ends_with(end)) continue;
        const auto markers = markers_in(robot.markers, column.substr(0, column.size() - end.size()), 2);
        if (markers.empty()) return std::nullopt;
        Channel channel = angle_channel(column, Channel::Kind::to_axis, markers);
        channel.axis = axis;
        return channel;
    }
    return std::nullopt;
}

Angle angle_of(const Channel& channel, std::span<const double> values) {
    if (channel.kind == Channel::Kind::to_axis)
        return angle_between(point(values, 1) - point(values, 0),
                             Vector3d::Unit(static_cast<Eigen::Index>(channel.axis)));
    return angle_between(point(values, 0) - point(values, 1), point(values, 2) - point(values, 1));
}

}  // namespace

double Channel::value(std::span<const double> of_measures) const {
    return factor * (kind == Kind::plain ? of_measures[0] : angle_of(*this, of_measures).value);
}

std::vector<double> Channel::slopes(std::span<const double> of_measures) const {
    if (kind == Kind::plain) return {factor};
    const Angle angle = angle_of(*this, of_measures);
    std::vector<double> result(of_measures.size(), 0.0);
    const auto add = [&](std::size_t point, const Vector3d& by) {
        for (std::size_t c = 0; c < 3; ++c) result[3 * point + c] += factor * by[static_cast<Eigen::Index>(c)];
    };
    if (kind == Kind::to_axis) {
        add(1, angle.by_a);
        add(0, -angle.by_a);
    } else {
        add(0, angle.by_a);
        add(2, angle.by_b);
        add(1, -angle.by_a - angle.by_b);
    }
    return result;
}

std::vector<Channel> plain_channels(const sim::Description& d) {
    std::vector<Channel> all;
    for (std::size_t k = 0; k < d.markers.size(); ++k)
        add_along_axes(MeasureKind::marker, k, d.markers[k].name, "mm", 1e3, all);
    add_each(d.cables,
             std::array<One, 3>{{{MeasureKind::length_ratio, "length_ratio", "", 1},
                                 {MeasureKind::length, "length", "mm", 1e3},
                                 {MeasureKind::tension, "tension", "N", 1}}},
             all);
    add_each(d.chambers,
             std::array<One, 3>{{{MeasureKind::volume_ratio, "volume_ratio", "", 1},
                                 {MeasureKind::volume, "volume", "mm3", 1e9},
                                 {MeasureKind::pressure, "pressure", "kPa", 1e-3}}},
             all);
    add_each(d.springs,
             std::array<One, 2>{
                 {{MeasureKind::spring_length, "length", "mm", 1e3}, {MeasureKind::spring_force, "force", "N", 1}}},
             all);
    for (std::size_t k = 0; k < d.supports.size(); ++k)
        add_along_axes(MeasureKind::reaction, k, d.supports[k].name + "_force", "N", 1, all);
    for (std::size_t k = 0; d.contact && k < d.contact->obstacles.size(); ++k)
        add_along_axes(MeasureKind::contact_force, k, d.contact->obstacles[k].body.name + "_force", "N", 1, all);
    if (d.contact) all.push_back({"self_contact_N", "N", 1, Channel::Kind::plain, {{MeasureKind::self_contact}}});
    return all;
}

std::vector<std::string> other_columns(const sim::Description& d) {
    std::vector<std::string> all;
    const auto add = [&](const std::string& name, const auto& endings) {
        for (const std::string_view ending : endings) all.push_back(fmt::format("{}_{}", name, ending));
    };
    for (const sim::FreeObject& object : d.objects) add(object.name, sim::columns::object);
    for (const sim::Joint& joint : d.joints) {
        add(joint.name, sim::columns::joint);
        if (joint.kind == sim::Joint::Kind::hinge) add(joint.name, sim::columns::turning);
        if (joint.kind == sim::Joint::Kind::slider) add(joint.name, sim::columns::sliding);
    }
    for (const sim::Sensor& sensor : d.sensors) {
        for (const auto& [name, quantity] : sim::readings_of(sensor))
            all.push_back(fmt::format("{}_{}{}", sensor.name, name, sim::shown(quantity).suffix));
    }
    return all;
}

std::optional<Channel> find_channel(const sim::Description& robot, std::string_view column) {
    std::vector<Channel> all = plain_channels(robot);
    const auto found = std::ranges::find(all, column, &Channel::column);
    if (found != all.end()) return std::move(*found);
    return find_angle(robot, column);
}

}  // namespace pliant::sim::identify
