// The matrix of a linearised state: its products, and solutions with it and with its transpose.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "base/linalg/cholesky.hpp"
#include "base/linalg/two_level.hpp"
#include "simulation/solver/equilibrium.hpp"

namespace pliant::sim {

enum class Side { direct, transposed };

/// Of a solution, beside the right-hand side: about as good as can be had; and enough for gradients, whose states are
/// known to fewer digits.
inline constexpr double best_residual = 1e-13, gradient_residual = 1e-8;

///     A = | K    B |     K  tangent over the free nodes, N/m: symmetric + skew
///         | C^T  D |     B  force of the unit of each multiplier; C  gradient of each constraint; D  compliances
///
/// Where a roller holds a node in a direction, A knows nothing of it: a component along it is left out of what comes in
/// and zero in what goes out.
struct LinearSystem {
    std::shared_ptr<const TangentLayout> layout;
    std::shared_ptr<const linalg::Analysis> analysis;  ///< of the layout's pattern, where it is known; else null
    bool two_levels = false;                           ///< a factor of K would take longer
    Eigen::VectorXd positions;                         ///< (3 free nodes) m, for those
    std::vector<FreeRoller> rollers;
    std::vector<double> symmetric;           ///< (entries of the layout's pattern)
    std::vector<double> skew;                ///< likewise, or empty where there is none
    Eigen::MatrixXd forces;                  ///< B (3 free nodes, solved)
    Eigen::MatrixXd constraints;             ///< C (3 free nodes, solved)
    Eigen::VectorXd compliance;              ///< the diagonal D (solved)
    std::vector<std::string> multipliers;    ///< (solved) what they belong to, for messages: cable "left"
    double wanted_residual = best_residual;  ///< of solutions, beside the right-hand side

    [[nodiscard]] Eigen::Index free_size() const { return forces.rows(); }
    [[nodiscard]] Eigen::Index size() const { return forces.rows() + forces.cols(); }
    /// A v, or A^T v; (size) -> (size).
    [[nodiscard]] Eigen::VectorXd multiply(const Eigen::VectorXd& v, Side side) const;
    /// Takes the components along which rollers hold nodes out of a vector (size).
    void leave_out_held(Eigen::VectorXd& v) const;
};

/// result += factor * S v of a skew matrix S whose blocks at and below the diagonal are given, in blocks of 3.
void add_skew_product(const linalg::SymmetricPattern& pattern, const std::vector<double>& values,
                      const Eigen::VectorXd& v, double factor, Eigen::VectorXd& result);

/// Solves with a LinearSystem. Its preconditioner is the exact inverse of the system without the skew part, but for
/// rounding: a Cholesky factor of K in single precision, or conjugate gradients on two levels, and the small Schur
/// complement D - C^T K^-1 B. Solutions are refined with residuals of the very system. What that does not solve, or is
/// nearly singular, is solved again with a factor in double precision. Where K is not positive definite, as at an
/// unstable equilibrium, a multiple of its diagonal is added to the preconditioner until it is, and GMRES (Saad and
/// Schultz 1986) makes good for that and for the skew part. Forces and constraints are balanced first: each multiplier
/// is scaled so that its column is as large as one of K.
class SystemSolver {
public:
    /// `system` must outlive it.
    explicit SystemSolver(const LinearSystem& system);
    ~SystemSolver();

    /// x with A x = b, or A^T x = b, to |b - A x| <= 10 |b| times what is wanted, in balanced units; or, where x is so
    /// much larger than b that rounding it makes more than that, to what rounding it makes; on two levels to about 1e-8
    /// of x in the norm of K, or to ten times what is wanted, 1e-6 at best. Of several solutions, where cables do the
    /// same, the one with the smallest multipliers. Errors: nothing solves it, since cables that do the same are asked
    /// for different things; the matrix is singular (a limit point, a bifurcation, a part that can move freely).
    [[nodiscard]] Result<Eigen::VectorXd> solve(const Eigen::VectorXd& b, Side side);

private:
    /// How K is solved with: as quick as it goes, or surely.
    enum class Way { none, two_levels, single_, double_ };
    [[nodiscard]] Status prepare();
    void begin();
    [[nodiscard]] bool begin_quickly(Way way);
    void begin_surely();
    [[nodiscard]] linalg::Cholesky& factor(linalg::Precision precision);
    [[nodiscard]] bool factorise();
    [[nodiscard]] bool solve_body(Eigen::MatrixXd& columns) const;
    [[nodiscard]] bool apply_body(Eigen::MatrixXd& columns) const;
    [[nodiscard]] bool take_schur_complement();
    template <class Solve>
    [[nodiscard]] bool take_schur_complement(const Solve& solve, double threshold);
    [[nodiscard]] bool is_far_from_singular() const;
    [[nodiscard]] bool is_content() const;
    [[nodiscard]] double level_tolerance() const;
    [[nodiscard]] double allowed_residual() const;
    [[nodiscard]] std::optional<Eigen::VectorXd> refine(const Eigen::VectorXd& b, Side side) const;
    [[nodiscard]] Eigen::VectorXd correction(const Eigen::VectorXd& residual, double wanted, Side side) const;
    [[nodiscard]] Eigen::VectorXd multiply(const Eigen::VectorXd& v, Side side) const;
    [[nodiscard]] Eigen::VectorXd precondition(const Eigen::VectorXd& v, Side side) const;
    [[nodiscard]] double rounding_of(const Eigen::VectorXd& x, Side side) const;
    [[nodiscard]] bool is_singular() const;
    void take_whole_factor();
    [[nodiscard]] Error redundancy() const;

    const LinearSystem* system_;
    Way way_ = Way::none;
    bool singular_ = false;
    bool exact_ = false;                        ///< the preconditioner is the inverse but for rounding
    double stiffness_ = 1;                      ///< mean of the diagonal of K, N/m
    Eigen::VectorXd column_, row_;              ///< (solved) scales of the multipliers and of the constraints
    Eigen::MatrixXd forces_;                    ///< B, scaled
    Eigen::MatrixXd constraints_;               ///< C, scaled
    Eigen::VectorXd compliance_;                ///< D, scaled
    std::unique_ptr<linalg::Cholesky> factor_;  ///< of K, or K with more on its diagonal
    std::unique_ptr<linalg::TwoLevel> levels_;  ///< of K
    Eigen::MatrixXd from_forces_;               ///< K^-1 B
    Eigen::MatrixXd from_constraints_;          ///< K^-1 C
    Eigen::MatrixXd schur_inverse_;             ///< of D - C^T K^-1 B, or the pseudo-inverse
    Eigen::MatrixXd schur_null_;                ///< columns: multipliers that do nothing
    using Whole = Eigen::SparseLU<Eigen::SparseMatrix<double>>;
    std::shared_ptr<Whole> whole_;  ///< of A, balanced, where GMRES finds no solution with the others
};

}  // namespace pliant::sim
