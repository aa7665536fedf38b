#include "simulation/stepper/impact.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <vector>

#include "simulation/contact/contact.hpp"
#include "simulation/elements/elements.hpp"

namespace pliant::sim {
namespace {

constexpr double least_share = 0.5;        // of the velocity
constexpr double noticeable_reach = 0.01;  // of the contact distance, in a step
constexpr double noticeable_turn = 1e-4;   // rad, or of the size of a sliding joint, in a step

/// Nodes that move as one: those of an object, or all others.
std::vector<std::vector<int>> things_of(const Equilibrium& system) {
    std::vector<int> others(system.model().elements().node_mass_kg().size());
    std::iota(others.begin(), others.end(), 0);
    std::vector<std::vector<int>> things;
    for (const AffineBody& object : system.objects()) {
        things.emplace_back(object.nodes().begin(), object.nodes().end());
        for (const int node : object.nodes()) others[static_cast<std::size_t>(node)] = -1;
    }
    std::erase(others, -1);
    things.push_back(std::move(others));
    return things;
}

/// Velocities at both ends of a step.
class VelocityChange {
public:
    VelocityChange(const Equilibrium& system, const Inertia& inertia, const Eigen::VectorXd& x)
        : masses_kg_(system.model().elements().node_mass_kg()),
          start_(inertia.start().v),
          end_(inertia.velocity(x)),
          change_(end_ - start_),
          dt_s_(inertia.dt()) {}

    [[nodiscard]] bool is_abrupt(const std::vector<int>& nodes, double least_reach_m) const {
        const double change = square(nodes, change_);
        return change >= least_share * least_share * std::max(square(nodes, start_), square(nodes, end_)) &&
               std::sqrt(change / mass_kg(nodes)) * dt_s_ > least_reach_m;
    }
    /// True if a change of forces (3n) explains at least half of it.
    [[nodiscard]] bool follows(const std::vector<int>& nodes, const Eigen::VectorXd& forces_N) const {
        double impulse_work = 0;
        for (const int node : nodes)
            impulse_work += dt_s_ * forces_N.segment<3>(3 * node).dot(change_.segment<3>(3 * node));
        return impulse_work >= 0.5 * square(nodes, change_);
    }

private:
    [[nodiscard]] double mass_kg(const std::vector<int>& nodes) const {
        double sum = 0;
        for (const int node : nodes) sum += masses_kg_[static_cast<std::size_t>(node)];
        return sum;
    }
    /// Sum of mass times velocity squared.
    [[nodiscard]] double square(const std::vector<int>& nodes, const Eigen::VectorXd& v) const {
        double sum = 0;
        for (const int node : nodes)
            sum += masses_kg_[static_cast<std::size_t>(node)] * v.segment<3>(3 * node).squaredNorm();
        return sum;
    }

    std::span<const double> masses_kg_;
    const Eigen::VectorXd& start_;
    Eigen::VectorXd end_, change_;
    double dt_s_;
};

bool is_struck(const Equilibrium& system, const State& from, const Controls& before, const State& to,
               const Controls& after) {
    const contact::Contact* contact = system.model().contact(after.met);
    const VelocityChange change(system, *after.inertia, to.x);
    std::vector<std::vector<int>> things = things_of(system);
    std::erase_if(things, [&](const std::vector<int>& nodes) {
        return nodes.empty() || !change.is_abrupt(nodes, noticeable_reach * contact->settings().distance_m);
    });
    if (things.empty()) return false;
    const Eigen::VectorXd forces_N = system.contact_node_forces(to, after) - system.contact_node_forces(from, before);
    return std::ranges::any_of(things, [&](const auto& nodes) { return change.follows(nodes, forces_N); });
}

bool is_stopped(const Equilibrium& system, const Touching& touching, const State& from, const State& to,
                const Controls& after) {
    const Inertia& inertia = *after.inertia;
    if (!(inertia.start().dt_before > 0)) return false;
    const std::vector<double> earlier = system.joint_coordinates(inertia.start().x_before, after);
    const std::vector<double> start = system.joint_coordinates(from.x, after);
    const std::vector<double> end = system.joint_coordinates(to.x, after);
    return std::ranges::any_of(touching.stops, [&](const std::array<int, 2>& stop) {
        const auto j = static_cast<std::size_t>(stop[0]);
        const double rate = (end[j] - start[j]) / inertia.dt();
        const double rate_before = (start[j] - earlier[j]) / inertia.start().dt_before;
        const double change = std::abs(rate - rate_before);
        const bool slides = system.model().description().joints[j].kind == Joint::Kind::slider;
        return change >= least_share * std::max(std::abs(rate), std::abs(rate_before)) &&
               change * inertia.dt() > noticeable_turn * (slides ? system.joints()[j].arm_m() : 1.0);
    });
}

}  // namespace

bool is_impact(const Equilibrium& system, const Touching& touching, const State& from, const Controls& before,
               const State& to, const Controls& after) {
    return (!touching.surfaces.empty() && is_struck(system, from, before, to, after)) ||
           (!touching.stops.empty() && is_stopped(system, touching, from, to, after));
}

}  // namespace pliant::sim
