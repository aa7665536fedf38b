// Whether a robot that is spread over ranks meets itself: from there on its equilibrium without contact is wrong.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "simulation/contact/contact.hpp"
#include "simulation/distributed/balance.hpp"

namespace pliant::sim::distributed {

/// Root looks, at the surface alone: that of a mesh of a million tets has some 50,000 nodes. All functions are
/// collective.
class Meeting {
public:
    /// `rules` as of the whole robot, nothing where it may pass through itself; they count on root alone. `balance`
    /// must outlive it.
    Meeting(const Balance& balance, const std::optional<ContactRules>& rules);

    /// True if on the straight way from one state of the known nodes (3n) to the next its surfaces come so near each
    /// other that they touch. Never where nobody asked, or what crosses at rest already cannot tell.
    [[nodiscard]] bool meets(const Eigen::VectorXd& from, const Eigen::VectorXd& to) const;
    /// On root: the robot passes through itself at rest.
    [[nodiscard]] bool crosses_at_rest() const { return crosses_at_rest_; }

private:
    [[nodiscard]] std::vector<double> gathered(const Eigen::VectorXd& x) const;
    [[nodiscard]] std::vector<int> gathered_numbers();
    void make_surface(const ContactRules& rules, const std::vector<int>& nodes, const std::vector<double>& rest);

    const Balance& balance_;
    bool looks_ = false;  ///< the same on all ranks
    bool crosses_at_rest_ = false;
    std::vector<int> counts_, starts_;                 ///< (ranks) numbers that each sends: three for each node
    std::unique_ptr<const contact::Contact> surface_;  ///< on root: of the nodes as they are gathered
};

}  // namespace pliant::sim::distributed
