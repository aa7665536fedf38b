// How far a robot that is spread over ranks is from equilibrium: Equilibrium (simulation/solver), of which each rank
// has a share.
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

/// Actuators are those of the whole robot, counted as in Equilibrium: cables, chambers, pressure loads. In State, x is
/// over the nodes that this rank knows (3n) and multipliers are the same on all ranks; in Evaluation, out_of_balance is
/// over its owned nodes (3 owned), all else is the same on all ranks. In Controls, external_N is what this rank adds to
/// the forces on its known nodes. Functions that say so are collective.
class Balance {
public:
    /// An error is that of one rank alone: a tet that is flat. Collective.
    [[nodiscard]] static Result<Balance> create(const Ranks& ranks, Share share);

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
    /// (3 owned) force of the unit of an actuator's multiplier over its measure at rest, on what is free. Collective.
    [[nodiscard]] Eigen::VectorXd measure_gradient(std::size_t actuator, const Eigen::VectorXd& x) const;
    /// What a sealed chamber gives by for each unit of multiplier: -dg/dm.
    [[nodiscard]] double gas_compliance(const Drive& drive, double multiplier) const;
    [[nodiscard]] bool is_cable(std::size_t actuator) const { return actuator < part().cables.size(); }
    [[nodiscard]] std::size_t actuator_count() const { return actuators_.size(); }
    /// (supports) the forces that they exert on the robot. Collective.
    [[nodiscard]] std::vector<Vec3> reactions(const Evaluation& evaluation) const;

    /// Node lists that elements and actuators of this rank couple.
    [[nodiscard]] linalg::Lists cliques() const;
    /// Adds this rank's share of the tangent, symmetric part, to a pattern over its known nodes, held ones too.
    void add_tangent(const State& state, const linalg::SymmetricPattern& pattern, const BlockSums& sums,
                     std::span<double> values, bool project) const;
    /// The same of the skew part. Precondition: has_skew().
    void add_skew(const State& state, const linalg::SymmetricPattern& pattern, std::span<double> values) const;
    /// Of a law without an energy, or of pressure on a patch with a free rim.
    [[nodiscard]] bool has_skew() const { return !conservative_; }
    [[nodiscard]] bool conservative() const { return conservative_; }
    [[nodiscard]] double energy_rounding_J() const { return energy_rounding_; }

    /// (nodes) that a support holds in some directions, of all that this rank knows: what they leave free.
    struct Roller {
        int node = 0;
        Eigen::Matrix3d may_move;
    };
    [[nodiscard]] const std::vector<Roller>& rollers() const { return rollers_; }
    /// Forces or motions (3 owned): none along what is held.
    void restrict_to_free(Eigen::VectorXd& owned) const;

    [[nodiscard]] const Share& share() const { return *share_; }
    [[nodiscard]] const Description& part() const { return share_->part; }
    [[nodiscard]] const Elements& elements() const { return *elements_; }
    [[nodiscard]] const NodeExchange& nodes() const { return *nodes_; }
    [[nodiscard]] const Ranks& ranks() const { return nodes_->ranks(); }
    /// (known nodes) 0, 1, 2, ...: the index of a pattern over all of them.
    [[nodiscard]] const std::vector<int>& all_nodes() const { return all_nodes_; }

private:
    Balance() = default;
    void add_actuators();
    void hold_nodes();
    void find_roundings();
    [[nodiscard]] double drive_energy(const Drive& drive, std::size_t actuator, double g) const;
    void fill_actuators(const State& state, const Controls& controls, const std::vector<double>& measures,
                        Evaluation& e) const;

    std::unique_ptr<const Share> share_;
    std::unique_ptr<const Elements> elements_;
    std::unique_ptr<const NodeExchange> nodes_;
    std::vector<std::optional<Actuator>> actuators_;  ///< this rank's part of each, where it has one
    std::vector<double> rest_measures_;
    std::vector<Support> supports_;     ///< those that hold nodes here
    std::vector<std::size_t> support_;  ///< of them, which of the robot
    std::unique_ptr<const HeldNodes> held_;
    std::vector<Roller> rollers_;
    std::vector<int> all_nodes_;
    Eigen::VectorXd rest_, gravity_;  ///< (3n)
    bool conservative_ = true;
    double force_floor_ = 0, energy_rounding_ = 0, force_rounding_ = 0;  ///< as in Equilibrium
};

}  // namespace pliant::sim::distributed
