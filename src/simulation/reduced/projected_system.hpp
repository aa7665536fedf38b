// The equations of a robot of weighted tets, projected on modes: x = X + V q, V^T r(x, m) = 0.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "base/core/error.hpp"
#include "simulation/reduced/sparse_weights.hpp"
#include "simulation/solver/equilibrium.hpp"
#include "simulation/stepper/inputs.hpp"

namespace pliant::sim::reduced {

/// The controls at these inputs, before any contact.
[[nodiscard]] Controls controls_at(const Equilibrium& system, const Inputs& inputs);

/// Amplitudes of the modes and multipliers of the actuators.
struct Projected {
    Eigen::VectorXd amplitudes;   ///< (modes) m
    Eigen::VectorXd multipliers;  ///< (actuators) as in State
};

/// Immutable: the tets that are evaluated, and the modes at their nodes and at those that something acts on.
class ProjectedModel {
public:
    /// `modes` (3n, count) of the whole robot.
    [[nodiscard]] static Result<ProjectedModel> create(const Description& whole,
                                                       const Eigen::Ref<const Eigen::MatrixXd>& modes,
                                                       const std::vector<Weight>& tets);

    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    [[nodiscard]] const Equilibrium& system() const { return *system_; }
    [[nodiscard]] const Rows& modes() const { return modes_; }  ///< (3 nodes, count)
    [[nodiscard]] const TangentLayout& layout() const { return *layout_; }
    [[nodiscard]] Eigen::VectorXd positions(const Eigen::VectorXd& amplitudes) const {
        return rest_ + modes_ * amplitudes;
    }
    [[nodiscard]] Controls controls(const Inputs& inputs) const { return controls_at(*system_, inputs); }

private:
    ProjectedModel() = default;
    std::unique_ptr<Model> model_;
    std::unique_ptr<Equilibrium> system_;
    std::unique_ptr<TangentLayout> layout_;  ///< over all nodes
    Rows modes_;
    Eigen::VectorXd rest_;
};

/// Newton's equations at a state. Not thread-safe: it has work space.
class ProjectedTangent {
public:
    /// `model` must outlive it.
    explicit ProjectedTangent(const ProjectedModel& model);

    /// Assembles at a state of the weighted tets with all multipliers known: Evaluation::multiplier.
    void assemble(const State& state, const Evaluation& evaluation, const Controls& controls);
    /// What Newton's step leads to: the change of the amplitudes, and the new multipliers. `forces` (modes) are the
    /// out-of-balance forces to be removed, with those of the multipliers. Cables that would push go slack; slack ones
    /// that would be too long become taut. Empty: the equations have no solution.
    [[nodiscard]] std::optional<Projected> step(const Eigen::VectorXd& forces) const;

private:
    /// An actuator that is driven by its measure.
    struct Constraint {
        Eigen::Index actuator = 0;
        bool only_pulls = false;
        double violation = 0;  ///< m or m^3
        double multiplier = 0;
        double scale = 1;          ///< makes its column as large as those of the modes
        Eigen::VectorXd gradient;  ///< (modes)
    };
    void add_block_products(const std::vector<double>& values, bool skew);
    void add_constraint(std::size_t actuator, const State& state, const Evaluation& evaluation);
    [[nodiscard]] Eigen::VectorXd gradient(std::size_t actuator, const Eigen::VectorXd& x) const;
    [[nodiscard]] Eigen::VectorXd solved(const std::vector<bool>& taut, const Eigen::VectorXd& balance) const;

    const ProjectedModel* model_;
    std::vector<double> stiffness_;  ///< (entries of the layout's pattern)
    std::vector<double> skew_;       ///< likewise; empty if the robot has no such part
    ProjectedModel::Rows products_;  ///< K V
    Eigen::MatrixXd reduced_;        ///< V^T K V
    double mean_stiffness_ = 1;      ///< of its diagonal
    std::vector<Constraint> driven_;
    Eigen::VectorXd multipliers_;  ///< (actuators)
};

}  // namespace pliant::sim::reduced
