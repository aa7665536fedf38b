#include "simulation/run/describe.hpp"

#include <Eigen/Geometry>
#include <span>
#include <string>

#include "base/linalg/vectors.hpp"

namespace pliant::sim {
namespace {

void describe_actuators(const Model& model, const Equilibrium& system, const State& state, std::span<const double> x,
                        Step& step) {
    const auto& d = model.description();
    for (std::size_t a = 0; a < d.steered_count(); ++a) {
        const Actuator& actuator = system.actuators()[a];
        const double measure = actuator.measure(x);
        const double ratio = measure / actuator.rest_measure();
        const double multiplier = acting_multiplier(system, state, a);
        if (a < d.cables.size())
            step.cables.push_back({d.cables[a].name, ratio, measure, multiplier});
        else  // 0 - 0 is 0, whereas -0 would show as a minus zero in every report
            step.chambers.push_back({d.chambers[a - d.cables.size()].name, ratio, measure, 0 - multiplier});
    }
}

void describe_contact(const Model& model, const Equilibrium& system, const State& state, const Controls& controls,
                      Step& step) {
    const contact::Forces forces = system.contact_forces(state, controls);
    const auto& obstacles = model.description().contact->obstacles;
    for (std::size_t k = 0; k < obstacles.size(); ++k)
        step.contacts.push_back({obstacles[k].body.name, forces.on_robot_N[k]});
    for (std::size_t k = 0; k < model.objects().size(); ++k) {
        step.objects.push_back(object_state(model, k, linalg::view(state.x)));
        step.objects.back().force_N = forces.on_rigid_N[k];
    }
    step.self_contact_N = forces.self_N;
    step.smallest_distance_m = forces.smallest_distance_m;
}

}  // namespace

JointState joint_state(const Equilibrium& system, std::size_t j, const State& state, const Controls& controls) {
    const JointForce& joint = system.joints()[j];
    const JointDrive drive = system.joint_drive(controls, j);
    const std::span<const double> x = linalg::view(state.x);
    const JointForce::Load load = joint.load(x, drive);
    const Joint& d = system.model().description().joints[j];
    return {d.name,
            {load.force[0], load.force[1], load.force[2]},
            {load.torque[0], load.torque[1], load.torque[2]},
            d.kind == Joint::Kind::hinge,
            d.kind == Joint::Kind::slider,
            joint.coordinate(x, drive.start),
            joint.effort(x, drive)};
}

ObjectState object_state(const Model& model, std::size_t k, std::span<const double> x) {
    const AffineBody& body = model.objects()[k];
    const linalg::Vector3 centre = body.centre(x);
    Eigen::Quaterniond turn(linalg::nearest_rotation(body.deformation(x)));
    if (turn.w() < 0) turn.coeffs() *= -1;
    return {model.description().objects[k].name,
            {centre[0], centre[1], centre[2]},
            {turn.w(), turn.x(), turn.y(), turn.z()},
            {}};
}

void describe(const Model& model, const Equilibrium& system, const State& state, const Controls& controls,
              const Evaluation& evaluation, Step& step) {
    const auto& d = model.description();
    const std::span<const double> x(state.x.data(), static_cast<std::size_t>(state.x.size()));
    step.residual = evaluation.residual;
    step.min_J = evaluation.min_J;
    step.energy_J = system.potential_energy(state, controls);
    describe_actuators(model, system, state, x, step);
    step.met = controls.met;
    if (model.contact(controls.met) != nullptr) describe_contact(model, system, state, controls, step);
    for (std::size_t s = 0; s < d.springs.size(); ++s) {
        const SpringPath& spring = system.springs()[s];
        step.springs.push_back({d.springs[s].name, spring.length(x), spring.force(x)});
    }
    for (std::size_t j = 0; j < d.joints.size(); ++j) step.joints.push_back(joint_state(system, j, state, controls));
    const std::vector<Vec3> reactions = model.held().reactions(d.supports, evaluation.out_of_balance);
    for (std::size_t s = 0; s < reactions.size(); ++s) step.supports.push_back({d.supports[s].name, reactions[s]});
    for (const Marker& marker : d.markers) step.markers.push_back({marker.name, position(marker.point, x)});
    for (const Sensor& sensor : d.sensors)
        step.sensors.push_back({sensor.name, read_sensor(sensor, system, state, controls)});
    step.positions = linalg::points_of(state.x);
}

}  // namespace pliant::sim
