// Contact and friction of one step, as they are, where everything else is linear.
//
// Forces of contact grow without bound within a fraction of its distance, and friction changes from sticking to
// slipping within some micrometres. Newton's step takes both for linear, so of a step in which many pairs begin to
// touch or to slip only as much can be taken as the first of them allows. Here the nodes that touch get a problem of
// their own,
//
//     minimise over δ   ½ (δ − δ₀)ᵀ S⁻¹ (δ − δ₀) + Ψ(x + δ)
//
// with Ψ the energy of contact and friction; S how these nodes yield to forces on them, A⁻¹ restricted to them, with A
// the tangent of everything else; and δ₀ how they would move without contact. It is what is left of the quadratic model
// of the step, with Ψ itself in the place of its expansion, when all other nodes are eliminated. With its forces the
// whole step is one solution more.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

class ContactStep {
public:
    /// With all pairs that are closer than (1 + beyond) times contact's distance, and those that rub. The arguments
    /// must outlive it. Precondition: the model has contact.
    ContactStep(const Equilibrium& system, const State& state, const Controls& controls, double beyond);

    /// Free nodes that move with these pairs, ascending.
    [[nodiscard]] const std::vector<int>& nodes() const { return nodes_; }
    /// Number of their coordinates, in the order of nodes().
    [[nodiscard]] Eigen::Index size() const { return 3 * static_cast<Eigen::Index>(nodes_.size()); }
    /// (size) indices of these coordinates among those of all free nodes.
    [[nodiscard]] std::vector<int> rows() const;

    /// (3 free) gradient of Ψ at the state, N.
    [[nodiscard]] Eigen::VectorXd gradient() const { return gradient(start_); }
    /// The same at the end of the step. `compliance`: S, (size, size), m/N; `without_m`: δ₀, (size). Empty: not found,
    /// as where the way there meets a pair that was left out.
    [[nodiscard]] std::optional<Eigen::VectorXd> solve(const Eigen::MatrixXd& compliance,
                                                       const Eigen::VectorXd& without_m) const;

private:
    struct Problem {
        Eigen::MatrixXd stiffness;  ///< S^-1
        const Eigen::VectorXd& without_m;
    };
    struct Place {
        Eigen::VectorXd delta;
        std::vector<double> x;  ///< of all nodes of contact
        double value;           ///< that is minimised, J
    };
    void add_carriers(std::span<const int> contact_nodes);
    void number_nodes();
    /// Of all nodes of contact.
    [[nodiscard]] std::vector<double> motion(const Eigen::VectorXd& delta) const;
    [[nodiscard]] double energy(const std::vector<double>& x) const;
    [[nodiscard]] double value(const Problem& problem, const Eigen::VectorXd& delta,
                               const std::vector<double>& x) const;
    [[nodiscard]] Eigen::VectorXd gradient(const std::vector<double>& x) const;
    [[nodiscard]] Eigen::MatrixXd hessian(const std::vector<double>& x, bool project) const;
    [[nodiscard]] std::optional<Eigen::VectorXd> newton_step(const Eigen::MatrixXd& stiffness,
                                                             const std::vector<double>& x,
                                                             const Eigen::VectorXd& slope) const;
    /// One step of Newton's method with a line search; false: none lowers the value. `slope`: gradient of the value.
    [[nodiscard]] bool descend(const Problem& problem, const Eigen::VectorXd& slope, Place& at) const;

    const Equilibrium& system_;
    const Controls& controls_;
    const contact::Contact& contact_;
    std::vector<double> start_;  ///< positions of all nodes of contact
    contact::Pairs pairs_;
    std::vector<int> nodes_;
    std::vector<int> place_;  ///< (mesh nodes) among nodes_, or -1
};

}  // namespace pliant::sim
