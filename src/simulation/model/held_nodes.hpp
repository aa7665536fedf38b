// Which nodes the supports hold, and in which directions: nodes of a clamp in all three, those of a roller or of a
// plane of symmetry in fewer.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/vec3.hpp"

namespace pliant::sim {

struct Support;

class HeldNodes {
public:
    /// Errors name the support: no nodes, nodes that do not exist, directions that are zero or not finite, a motion
    /// that is not finite, nodes that two supports hold in the same direction while one of them moves, or that two
    /// supports hold in all directions.
    [[nodiscard]] static Result<HeldNodes> create(std::span<const Support> supports, int node_count);

    /// True if the node is held in all directions.
    [[nodiscard]] bool is_fixed(int node) const { return fixed_[static_cast<std::size_t>(node)]; }

    /// A node that is held in one or two directions.
    struct Roller {
        int node = 0;
        Eigen::Matrix3d may_move;  ///< projector onto the directions in which it may move
    };
    /// Ascending by node.
    [[nodiscard]] const std::vector<Roller>& rollers() const { return rollers_; }

    /// Moves every held node to where its supports prescribe, only along the held directions. `shares` (supports) of
    /// their motion; `rest` (n); x (3n). All in metres.
    void place(std::span<const Support> supports, std::span<const Vec3> rest, std::span<const double> shares,
               Eigen::VectorXd& x) const;

    /// Position, or velocity, that a support prescribes for one of its nodes: (support, node), m.
    using Wanted = std::function<Eigen::Vector3d(std::size_t support, int node)>;
    /// (3n) motion of the held nodes along their held directions, for the prescribed motion; zero elsewhere.
    [[nodiscard]] Eigen::VectorXd motion(const Wanted& wanted) const;

    /// The transpose of motion(): distributes `weights` (3n) of the nodes' motion over the prescribed motion of each
    /// support and node.
    using TakeWeight = std::function<void(std::size_t support, int node, const Eigen::Vector3d& weight)>;
    void visit_weights(const Eigen::VectorXd& weights, const TakeWeight& take) const;

    /// The force that each support exerts on the robot, (supports) N. `out_of_balance` (3n) are internal minus external
    /// forces. The force at a node shared by two supports is split between them with minimum norm.
    [[nodiscard]] std::vector<Vec3> reactions(std::span<const Support> supports,
                                              const Eigen::VectorXd& out_of_balance) const;

private:
    using Directions = Eigen::Matrix<double, Eigen::Dynamic, 3>;  ///< orthonormal rows
    struct Shared {
        int node = 0;
        std::vector<int> supports;  ///< at least two
        Directions directions;      ///< of all of them, stacked
    };
    HeldNodes() = default;
    void move(const Wanted& wanted, Eigen::VectorXd& x) const;
    [[nodiscard]] Status add_shared(std::span<const Support> supports, int node, const std::vector<int>& holders);
    [[nodiscard]] Status check_shared(std::span<const Support> supports, const std::vector<int>& holders) const;

    std::vector<Directions> directions_;   ///< (supports)
    std::vector<std::vector<int>> alone_;  ///< (supports) nodes that no other support holds
    std::vector<Shared> shared_;
    std::vector<bool> fixed_;  ///< (n)
    std::vector<Roller> rollers_;
};

}  // namespace pliant::sim
