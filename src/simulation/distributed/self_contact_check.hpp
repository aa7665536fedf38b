// Whether a distributed robot meets itself: its equilibrium without contact is then wrong.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "simulation/contact/contact.hpp"
#include "simulation/distributed/distributed_equilibrium.hpp"

namespace pliant::sim::distributed {

/// Root checks, with the surface alone: that of a mesh of a million tets has some 50,000 nodes. All functions are
/// collective.
class SelfContactCheck {
public:
    /// `rules`: those of the whole robot, none if it may pass through itself; used on root alone. `system` must outlive
    /// it.
    SelfContactCheck(const DistributedEquilibrium& system, const std::optional<ContactRules>& rules);

    /// True if the surfaces touch on the straight path between two states of the local nodes (3n). Always false without
    /// rules, and for a robot that crosses itself at rest.
    [[nodiscard]] bool meets(const Eigen::VectorXd& from, const Eigen::VectorXd& to) const;
    /// On root: the robot crosses itself at rest.
    [[nodiscard]] bool crosses_at_rest() const { return crosses_at_rest_; }

private:
    [[nodiscard]] std::vector<double> gathered(const Eigen::VectorXd& x) const;
    [[nodiscard]] std::vector<int> gathered_numbers();
    void make_surface(const ContactRules& rules, const std::vector<int>& nodes, const std::vector<double>& rest);

    const DistributedEquilibrium& system_;
    bool looks_ = false;  ///< the same on all ranks
    bool crosses_at_rest_ = false;
    std::vector<int> counts_, starts_;                 ///< (ranks) numbers that each sends: three per node
    std::unique_ptr<const contact::Contact> surface_;  ///< on root, with nodes in the order in which they are gathered
};

}  // namespace pliant::sim::distributed
