// Lagged friction: normal forces and tangent planes are frozen at one state, so that friction has a potential (Li,
// Ferguson, Schneider et al. 2020, section 5).
//
//     E = Σ μ λ f(|u|)      u = c + Tᵀ Σ wᵢ (xᵢ − xᵢ⁰)      f(y) = y²/ε − y³/3ε² + ε/3 below ε, y beyond
//
// Frozen are the normal force λ, two unit tangents T and the weights w of the nearest points. x⁰ is the start of the
// step and ε the slip over which friction grows from zero to μλ. Friction has memory: c is the slip at the end of the
// previous step, limited to ε (carry_over). Surfaces that stick under a constant load stay in place, step after step,
// and sliding ones drag their anchor along: an elastic-plastic law with the return mapping of Simo and Hughes 1998,
// chapter 1, between steps. In Li et al. c is zero, and sticking surfaces creep in every step.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/linalg/small.hpp"
#include "simulation/contact/pairs.hpp"

namespace pliant::sim::contact {

/// Receives one 3 × 3 block of a symmetric matrix of nodes; both (i, j) and (j, i) are given.
using BlockVisitor = std::function<void(int i, int j, const linalg::Matrix3& block)>;

/// One frozen pair.
struct FrozenPair {
    std::array<int, 4> nodes{};
    std::array<double, 4> weights{};
    std::array<Vec3, 2> tangents;
    std::array<double, 2> carried_m{};  ///< c, along the tangents
    double limit_N = 0;                 ///< μ λ
    int node_count = 4;
    int first_count = 1;  ///< nodes of the first feature
    int obstacle = -1;
    bool robot_first = true;
    std::int64_t flat_face = -1;  ///< as in Pair
};

/// `coefficient`: μ of the pair. `x`: positions at which it is frozen.
[[nodiscard]] FrozenPair freeze(const Pair& pair, double coefficient, double stiffness_Pa, const Stencil& x);

class Friction {
public:
    /// `step_start` (3 nodes) is copied. Precondition: slip_m > 0.
    Friction(std::vector<FrozenPair> pairs, std::vector<double> step_start, double slip_m);

    /// J. All functions take positions (3 nodes), metres.
    [[nodiscard]] double energy(std::span<const double> x) const;
    /// Adds the gradient of the energy, which is minus the force on the nodes, N.
    void add_gradient(std::span<const double> x, std::span<double> gradient) const;
    /// Positive semi-definite, so there is nothing to project.
    void visit_hessian(std::span<const double> x, const BlockVisitor& visit) const;

    [[nodiscard]] std::span<const FrozenPair> pairs() const { return pairs_; }
    /// (3 nodes) positions at the start of the step.
    [[nodiscard]] std::span<const double> start() const { return start_; }
    [[nodiscard]] double slip_m() const { return slip_m_; }
    /// Force on the first feature of pair `k`, N.
    [[nodiscard]] Vec3 force(std::size_t k, std::span<const double> x) const;
    /// Slip u along the two tangents, m.
    [[nodiscard]] std::array<double, 2> slip(const FrozenPair& pair, std::span<const double> x) const;
    /// Derivative of that force with respect to u, N/m: the second derivative of the energy along the two tangents.
    [[nodiscard]] Eigen::Matrix2d stiffness(std::size_t k, std::span<const double> x) const;

private:
    std::vector<FrozenPair> pairs_;
    std::vector<double> start_;
    double slip_m_;
};

/// Slip that a pair of this step takes over from a pair of the previous step: c = change · (slip there, at most ε).
struct Carry {
    std::size_t from = 0, to = 0;  ///< index of the pair in the previous step, and in this one
    Eigen::Matrix2d change;        ///< from old tangents to new ones, following the rotation of the normal
};
/// For pairs of the same features, in the order of `now`.
[[nodiscard]] std::vector<Carry> find_carries(std::span<const FrozenPair> before, std::span<const FrozenPair> now);

/// The slip that is carried over: limited to the slip that counts as sticking.
[[nodiscard]] Eigen::Vector2d kept_slip(const std::array<double, 2>& slip, double slip_m);
/// Its derivative with respect to the slip.
[[nodiscard]] Eigen::Matrix2d kept_slip_gradient(const std::array<double, 2>& slip, double slip_m);

/// Sets `carried_m` of the pairs of a step that starts from x (3 nodes), where the step with `before` ended.
void carry_over(const Friction& before, std::span<const double> x, std::span<FrozenPair> pairs);

}  // namespace pliant::sim::contact
