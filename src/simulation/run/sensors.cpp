#include "simulation/run/sensors.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "base/linalg/vectors.hpp"

namespace pliant::sim {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double degrees = 57.29577951308232;
/// A node counts as pressed if its pressure is above this share of the patch's largest: the contact barrier does not
/// reach exactly zero.
constexpr double pressed_share = 0.01;

Vector3d place(const AttachedFrame& frame, std::span<const double> x) {
    Vector3d sum = Vector3d::Zero();
    for (std::size_t i = 0; i < frame.nodes.size(); ++i) sum += frame.weights[i] * linalg::view(x, frame.nodes[i]);
    return sum;
}

/// The deformation gradient of the frame at these positions, or for velocities their gradient with respect to the rest
/// position.
Matrix3d slope(const AttachedFrame& frame, std::span<const double> x) {
    Matrix3d sum = Matrix3d::Zero();
    for (std::size_t i = 0; i < frame.nodes.size(); ++i)
        sum += linalg::view(x, frame.nodes[i]) * linalg::vector(frame.gradients[i]).transpose();
    return sum;
}

Matrix3d columns(const std::array<Vec3, 3>& axes) {
    Matrix3d matrix;
    for (int k = 0; k < 3; ++k) matrix.col(k) = linalg::vector(axes[static_cast<std::size_t>(k)]);
    return matrix;
}

Vector3d rotation_vector(const Matrix3d& rotation) {
    const Eigen::AngleAxisd turn(rotation);
    return turn.angle() * turn.axis();
}

/// Everything that a sensor can read.
struct Scene {
    const Equilibrium& system;
    const State& state;
    const Controls& controls;
    std::span<const double> x;
};

double length_of(const std::vector<Attachment>& points, std::span<const double> x) {
    double length = 0;
    for (std::size_t i = 1; i < points.size(); ++i) length += norm(position(points[i], x) - position(points[i - 1], x));
    return length;
}

std::vector<double> read(const StrainSensor& sensor, const Scene& scene) {
    const Eigen::VectorXd rest = scene.system.rest().x;
    const double length = length_of(sensor.points, scene.x);
    return {length / length_of(sensor.points, linalg::view(rest)) - 1, length};
}

/// The rotation from section to section in the axes of the first: its third component is twist, the others are bending.
std::vector<double> read(const BackboneSensor& sensor, const Scene& scene) {
    std::vector<double> pieces;
    double length = 0, bend = 0, twist = 0;
    const auto turned = [&](std::size_t k) -> Matrix3d {
        return linalg::nearest_rotation(slope(sensor.sections[k], scene.x)) * columns(sensor.axes[k]);
    };
    Matrix3d before = turned(0);
    for (std::size_t k = 1; k < sensor.sections.size(); ++k) {
        const Matrix3d now = turned(k);
        const double piece = (place(sensor.sections[k], scene.x) - place(sensor.sections[k - 1], scene.x)).norm();
        const Vector3d turn = rotation_vector(before.transpose() * now);
        const double bent = turn.head<2>().norm();
        pieces.insert(pieces.end(), {bent / piece, turn[2] / piece});
        length += piece;
        bend += bent;
        twist += turn[2];
        before = now;
    }
    std::vector<double> readings{bend, twist, bend / length};
    readings.insert(readings.end(), pieces.begin(), pieces.end());
    return readings;
}

std::vector<double> read(const ContactSensor& sensor, const Scene& scene) {
    Vector3d force = Vector3d::Zero();
    double normal = 0, area = 0, largest = 0;
    if (scene.system.model().contact(scene.controls.met) != nullptr) {
        const Eigen::VectorXd forces = scene.system.contact_node_forces(scene.state, scene.controls);
        const contact::Forces all = scene.system.contact_forces(scene.state, scene.controls);
        const auto pressure = [&](std::size_t k) { return all.pressure_Pa[static_cast<std::size_t>(sensor.nodes[k])]; };
        for (std::size_t k = 0; k < sensor.nodes.size(); ++k) largest = std::max(largest, pressure(k));
        for (std::size_t k = 0; k < sensor.nodes.size(); ++k) {
            force += forces.segment<3>(3 * static_cast<Eigen::Index>(sensor.nodes[k]));
            normal += pressure(k) * sensor.owned_m2[k];
            if (pressure(k) > pressed_share * largest) area += sensor.areas_m2[k];
        }
    }
    return {force[0], force[1], force[2], normal, area, area > 0 ? normal / area : 0};
}

std::vector<double> read(const DistanceSensor& sensor, const Scene& scene) {
    return {norm(position(sensor.points[1], scene.x) - position(sensor.points[0], scene.x))};
}

/// Angular velocity of a frame: the skew part of the velocity gradient with respect to the current position.
Vector3d spin(const AttachedFrame& frame, const Matrix3d& deformation, const Eigen::VectorXd& v) {
    const Matrix3d L = slope(frame, linalg::view(v)) * deformation.inverse();
    return 0.5 * Vector3d(L(2, 1) - L(1, 2), L(0, 2) - L(2, 0), L(1, 0) - L(0, 1));
}

Matrix3d axes_of(const MotionSensor& sensor, std::span<const double> x) {
    return linalg::nearest_rotation(slope(sensor.frame, x)) * columns(sensor.axes);
}

std::vector<double> read(const MotionSensor& sensor, const Scene& scene) {
    const Description& d = scene.system.model().description();
    const Matrix3d axes = axes_of(sensor, scene.x);
    Matrix3d axes_of_acceleration = axes;
    Vector3d acceleration = -d.gravity_share.at(scene.controls.time) * linalg::vector(d.gravity_m_s2);
    Vector3d turning = Vector3d::Zero();
    if (scene.controls.inertia && !scene.controls.inertia->is_tether()) {
        const Eigen::VectorXd a = scene.controls.inertia->true_acceleration(scene.state.x);
        const Eigen::VectorXd v = scene.controls.inertia->velocity(scene.state.x);
        acceleration += place(sensor.frame, linalg::view(a));
        turning = spin(sensor.frame, slope(sensor.frame, scene.x), v);
        if (scene.controls.inertia->scheme() == Scheme::conserving) {  // the mean of the step, so in the axes halfway
            const Eigen::VectorXd halfway = scene.controls.inertia->on_path(scene.state.x, 0.5);
            axes_of_acceleration = axes_of(sensor, linalg::view(halfway));
        }
    }
    const Vector3d a = axes_of_acceleration.transpose() * acceleration, w = axes.transpose() * turning;
    return {a[0], a[1], a[2], w[0], w[1], w[2]};
}

/// As in the results of cables and chambers, without the resistance of gap and air elements.
std::vector<double> read(const ActuatorSensor& sensor, const Scene& scene) {
    const std::size_t a =
        sensor.index + (sensor.kind == ActuatorSensor::Kind::tension ? 0 : scene.system.cable_count());
    switch (sensor.kind) {
        case ActuatorSensor::Kind::tension:
            return {acting_multiplier(scene.system, scene.state, a)};
        case ActuatorSensor::Kind::volume:
            return {scene.system.actuators()[a].measure(scene.x)};
        case ActuatorSensor::Kind::pressure:
            return {0 - acting_multiplier(scene.system, scene.state, a)};
    }
    return {};
}

}  // namespace

double acting_multiplier(const Equilibrium& system, const State& state, std::size_t a) {
    const Description& d = system.model().description();
    const Actuator& actuator = system.actuators()[a];
    const std::span<const double> x = linalg::view(state.x);
    double multiplier = state.multiplier[static_cast<Eigen::Index>(a)];
    if (actuator.gaps() != nullptr) multiplier = actuator.gaps()->tension(x, multiplier);
    for (const Growth& growth : d.growths) {
        if (a >= d.cables.size() && growth.actuator == static_cast<int>(a))
            return multiplier + growth.weight_Pa * (actuator.measure(x) / actuator.rest_measure() - 1);
    }
    return multiplier + 0;
}

Shown shown(SensedQuantity quantity) {
    switch (quantity) {
        case SensedQuantity::ratio:
            break;
        case SensedQuantity::length:
            return {"_mm", 1e3, "mm", "m"};
        case SensedQuantity::angle:
            return {"_deg", degrees, "deg", "rad"};
        case SensedQuantity::curvature:
            return {"_per_m", 1, "1/m", "1/m"};
        case SensedQuantity::twist_rate:
            return {"_deg_per_m", degrees, "deg/m", "rad/m"};
        case SensedQuantity::force:
            return {"_N", 1, "N", "N"};
        case SensedQuantity::area:
            return {"_mm2", 1e6, "mm^2", "m^2"};
        case SensedQuantity::volume:
            return {"_mm3", 1e9, "mm^3", "m^3"};
        case SensedQuantity::pressure:
            return {"_kPa", 1e-3, "kPa", "Pa"};
        case SensedQuantity::acceleration:
            return {"_m_per_s2", 1, "m/s^2", "m/s^2"};
        case SensedQuantity::angular_velocity:
            return {"_rad_per_s", 1, "rad/s", "rad/s"};
    }
    return {"", 1, "", ""};
}

namespace {

using Names = std::vector<std::pair<std::string, SensedQuantity>>;

void add_names(std::string_view name, SensedQuantity quantity, Names& names) {
    for (const char axis : {'x', 'y', 'z'}) names.emplace_back(fmt::format("{}_{}", name, axis), quantity);
}

Names names_of(const StrainSensor&) {
    return {{"strain", SensedQuantity::ratio}, {"length", SensedQuantity::length}};
}

Names names_of(const BackboneSensor& sensor) {
    Names names{
        {"bend", SensedQuantity::angle}, {"twist", SensedQuantity::angle}, {"curvature", SensedQuantity::curvature}};
    for (std::size_t k = 1; k < sensor.sections.size(); ++k) {
        names.emplace_back(fmt::format("curvature_{}", k), SensedQuantity::curvature);
        names.emplace_back(fmt::format("twist_rate_{}", k), SensedQuantity::twist_rate);
    }
    return names;
}

Names names_of(const ContactSensor&) {
    Names names;
    add_names("force", SensedQuantity::force, names);
    names.emplace_back("normal_force", SensedQuantity::force);
    names.emplace_back("area", SensedQuantity::area);
    names.emplace_back("pressure", SensedQuantity::pressure);
    return names;
}

Names names_of(const ActuatorSensor& sensor) {
    switch (sensor.kind) {
        case ActuatorSensor::Kind::tension:
            return {{"tension", SensedQuantity::force}};
        case ActuatorSensor::Kind::volume:
            return {{"volume", SensedQuantity::volume}};
        case ActuatorSensor::Kind::pressure:
            return {{"pressure", SensedQuantity::pressure}};
    }
    return {};
}

Names names_of(const DistanceSensor&) {
    return {{"distance", SensedQuantity::length}};
}

Names names_of(const MotionSensor&) {
    Names names;
    add_names("acceleration", SensedQuantity::acceleration, names);
    add_names("angular_velocity", SensedQuantity::angular_velocity, names);
    return names;
}

}  // namespace

std::vector<std::pair<std::string, SensedQuantity>> readings_of(const Sensor& sensor) {
    return std::visit([](const auto& what) { return names_of(what); }, sensor.what);
}

std::vector<Reading> read_sensor(const Sensor& sensor, const Equilibrium& system, const State& state,
                                 const Controls& controls) {
    const Scene scene{system, state, controls, linalg::view(state.x)};
    const std::vector<double> values = std::visit([&](const auto& what) { return read(what, scene); }, sensor.what);
    std::vector<Reading> readings;
    Names names = readings_of(sensor);
    for (std::size_t k = 0; k < names.size(); ++k)
        readings.push_back({std::move(names[k].first), names[k].second, values[k]});
    return readings;
}

}  // namespace pliant::sim
