#include "simulation/run/describe.hpp"

#include <Eigen/Geometry>
#include <span>
#include <string>

#include "base/linalg/vectors.hpp"

namespace pliant::sim {
namespace {

/// Pressure with which the elements of a chamber's air resist its volume: what they press with beyond that is left for
/// the walls. 0 where the air is not meshed.
double air_resistance(const Description& d, std::size_t actuator, double volume_ratio) {
    for (const Growth& growth : d.growths) {
        if (actuator >= d.cables.size() && growth.actuator == static_cast<int>(actuator))
            return growth.weight_Pa * (volume_ratio - 1);
    }
    return 0;
}

void describe_actuators(const Model& model, const Equilibrium& system, const State& state, std::span<const double> x,
                        Step& step) {
    const auto& d = model.description();
    for (std::size_t a = 0; a < d.cables.size() + d.chambers.size(); ++a) {
        const Actuator& actuator = system.actuators()[a];
        const double measure = actuator.measure(x);
        const double ratio = measure / actuator.rest_measure();
        double multiplier = state.multiplier[static_cast<Eigen::Index>(a)];
        if (actuator.gaps() != nullptr) multiplier = actuator.gaps()->tension(x, multiplier);
        multiplier += air_resistance(d, a, ratio);
        if (a < d.cables.size())
            step.cables.push_back({d.cables[a].name, ratio, measure, multiplier});
        else  // 0 - 0 is 0, where -0 would be a minus zero in every report
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
    const std::vector<Vec3> reactions = model.held().reactions(d.supports, evaluation.out_of_balance);
    for (std::size_t s = 0; s < reactions.size(); ++s) step.supports.push_back({d.supports[s].name, reactions[s]});
    for (const Marker& marker : d.markers) step.markers.push_back({marker.name, position(marker.point, x)});
    step.positions = linalg::points_of(state.x);
}

}  // namespace pliant::sim
