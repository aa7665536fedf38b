// How far a robot that is distributed over ranks is from equilibrium: Equilibrium (simulation/solver), of which each
// rank has a share.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "simulation/actuators/actuator.hpp"
#include "simulation/distributed/node_exchange.hpp"
#include "simulation/distributed/share.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/model/held_nodes.hpp"
#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim::distributed {

/// Actuators are those of the whole robot, in the order of Equilibrium: cables, chambers, pressure loads. In State, x
/// is over the local nodes (3n) and the multipliers are the same on all ranks; in Evaluation, out_of_balance is over
/// the owned nodes (3 owned), everything else is the same on all ranks. In Controls, external_N is this rank's
/// contribution to the forces on its local nodes. Functions that say so are collective.
class DistributedEquilibrium {
public:
    /// Error: a flat tet, on any rank. Collective.
    [[nodiscard]] static Result<DistributedEquilibrium> create(const Ranks& ranks, Share share);

    [[nodiscard]] Controls controls(double time) const;
    [[nodiscard]] State rest() const;
    void place_supports(const Controls& controls, Eigen::VectorXd& x) const;
    /// Collective.
    [[nodiscard]] Evaluation evaluate(const State& state, const Controls& controls) const;
    /// Elastic energy minus the work of dead loads and gravity since rest, of the whole robot. Collective.
    [[nodiscard]] double potential_energy(const State& state, const Controls& controls) const;
    /// (actuators) lengths and volumes. Collective.
    [[nodiscard]] std::vector<double> measures(const Eigen::VectorXd& x) const;
    [[nodiscard]] double rest_measure(std::size_t actuator) const { return rest_measures_[actuator]; }
    [[nodiscard]] const std::vector<double>& rest_measures() const { return rest_measures_; }
    /// (3 owned) force per unit of an actuator's multiplier, divided by its measure at rest, on free nodes. Collective.
    [[nodiscard]] Eigen::VectorXd measure_gradient(std::size_t actuator, const Eigen::VectorXd& x) const;
    [[nodiscard]] bool is_cable(std::size_t actuator) const { return actuator < part().cables.size(); }
    [[nodiscard]] std::size_t actuator_count() const { return actuators_.size(); }
    /// (supports) the forces that they exert on the robot. Collective.
    [[nodiscard]] std::vector<Vec3> reactions(const Evaluation& evaluation) const;

    /// Groups of nodes that elements and actuators of this rank couple.
    [[nodiscard]] linalg::Lists cliques() const;
    /// Adds this rank's share of the symmetric part of the tangent to a pattern over its local nodes, including held
    /// ones.
    void add_tangent(const State& state, const linalg::SymmetricPattern& pattern, const BlockSums& sums,
                     std::span<double> values, bool project) const;
    /// The same for the skew part. Precondition: has_skew().
    void add_skew(const State& state, const linalg::SymmetricPattern& pattern, std::span<double> values) const;
    /// True for a law without an energy, and for pressure on a patch with a free rim.
    [[nodiscard]] bool has_skew() const { return !conservative_; }
    [[nodiscard]] bool conservative() const { return conservative_; }
    [[nodiscard]] double energy_rounding_J() const { return energy_rounding_; }

    /// A local node that a support holds in one or two directions.
    struct Roller {
        int node = 0;
        Eigen::Matrix3d may_move;  ///< projector onto the directions in which it may move
    };
    [[nodiscard]] const std::vector<Roller>& rollers() const { return rollers_; }
    /// Removes the components of forces or motions (3 owned) along the directions that are held.
    void restrict_to_free(Eigen::VectorXd& owned) const;

    [[nodiscard]] const Share& share() const { return *share_; }
    [[nodiscard]] const Description& part() const { return share_->part; }
    [[nodiscard]] const Elements& elements() const { return *elements_; }
    [[nodiscard]] const NodeExchange& nodes() const { return *nodes_; }
    [[nodiscard]] const Ranks& ranks() const { return nodes_->ranks(); }
    /// (local nodes) 0, 1, 2, ...: the index of a pattern over all of them.
    [[nodiscard]] const std::vector<int>& all_nodes() const { return all_nodes_; }

private:
    DistributedEquilibrium() = default;
    void add_actuators();
    void hold_nodes();
    void find_roundings();

    std::unique_ptr<const Share> share_;
    std::unique_ptr<const Elements> elements_;
    std::unique_ptr<const NodeExchange> nodes_;
    std::vector<std::optional<Actuator>> actuators_;  ///< this rank's part of each, if it has one
    std::vector<double> rest_measures_;
    std::vector<Support> supports_;     ///< those that hold local nodes
    std::vector<std::size_t> support_;  ///< their indices in the robot
    std::unique_ptr<const HeldNodes> held_;
    std::vector<Roller> rollers_;
    std::vector<int> all_nodes_;
    Eigen::VectorXd rest_, gravity_;  ///< (3n)
    bool conservative_ = true;
    double force_floor_ = 0, energy_rounding_ = 0, force_rounding_ = 0;  ///< as in Equilibrium
};

}  // namespace pliant::sim::distributed
