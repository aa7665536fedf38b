// Solves with the tangent of everything except contact and friction, by a factor of its own.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "base/core/aligned_array.hpp"
#include "simulation/solver/curvature.hpp"
#include "simulation/solver/tangent_inverse.hpp"

namespace pliant::sim {

class InverseWithoutContact {
public:
    /// Both must outlive it.
    InverseWithoutContact(const Equilibrium& system, const FactoredLaplacian& laplacian)
        : system_(&system), laplacian_(&laplacian) {}

    /// columns (3 free, k) <- A^-1 columns at the state of `tangent`, or with the positive projection of A where A is
    /// not positive definite. The factor is kept for the next call with the same tangent. False: neither has one, or it
    /// would take too much memory, or much longer than an iteration with the preconditioner on levels.
    [[nodiscard]] bool solve(const std::shared_ptr<const SolverMemory::Tangent>& tangent, Eigen::MatrixXd& columns);

private:
    [[nodiscard]] bool is_quick() const;
    [[nodiscard]] bool factorise(const SolverMemory::Tangent& tangent, bool project);

    const Equilibrium* system_;
    const FactoredLaplacian* laplacian_;
    AlignedArray<double> values_;
    std::unique_ptr<TangentInverse> inverse_;
    std::shared_ptr<const SolverMemory::Tangent> of_;  ///< the tangent whose factor this is
    bool usable_ = false;
};

}  // namespace pliant::sim
