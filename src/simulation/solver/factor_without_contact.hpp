// The tangent of everything except contact and friction, factorised.
#pragma once

#include <memory>
#include <optional>

#include "base/core/aligned_array.hpp"
#include "base/linalg/cholesky.hpp"
#include "simulation/solver/curvature.hpp"

namespace pliant::sim {

class FactorWithoutContact {
public:
    /// Both must outlive it.
    FactorWithoutContact(const Equilibrium& system, const FactoredLaplacian& laplacian)
        : system_(&system), laplacian_(&laplacian) {}

    /// The factor at the state of `tangent`, or that of the positive projection where the tangent is not positive
    /// definite; it is kept for the next call with the same tangent. Null: neither has one, or it would take too much
    /// memory, or much longer than an iteration with the preconditioner on levels.
    [[nodiscard]] const linalg::Cholesky* at(const std::shared_ptr<const SolverMemory::Tangent>& tangent);

private:
    [[nodiscard]] bool is_quick() const;
    [[nodiscard]] bool factorise(const SolverMemory::Tangent& tangent, bool project);

    const Equilibrium* system_;
    const FactoredLaplacian* laplacian_;
    AlignedArray<double> values_;
    std::optional<linalg::Cholesky> factor_;
    std::shared_ptr<const SolverMemory::Tangent> of_;  ///< the tangent whose factor this is
    bool usable_ = false;
};

}  // namespace pliant::sim
