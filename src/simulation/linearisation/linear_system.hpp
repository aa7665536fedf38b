// The matrix of a linearised state: products and solves with it and its transpose.
#pragma once

#include <Eigen/Core>
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

/// Target residuals of a solve, relative to the right-hand side: about the best achievable; and enough for gradients,
/// whose states are known to fewer digits.
inline constexpr double best_residual = 1e-13, gradient_residual = 1e-8;

///     A = | K    B |     K  tangent over the free nodes, N/m: symmetric + skew
///         | C^T  D |     B  force per unit of each multiplier; C  gradient of each constraint; D  compliances
///
/// Where a roller holds a node in a direction, that component is not part of A: it is ignored in the input and zero in
/// the output.
struct LinearSystem {
    std::shared_ptr<const TangentLayout> layout;
    std::shared_ptr<const linalg::Analysis> analysis;  ///< of the layout's pattern, if known; else null
    bool on_levels = false;                            ///< factorising K would take longer than iterating on levels
    std::optional<linalg::Nesting> corners;            ///< of quadratic tets, as the second level; else groups of nodes
    Eigen::VectorXd positions;                         ///< (3 free nodes) positions of the free nodes, m
    std::vector<FreeRoller> rollers;
    std::vector<double> symmetric;           ///< (entries of the layout's pattern)
    std::vector<double> skew;                ///< likewise; empty if there is no skew part
    Eigen::MatrixXd forces;                  ///< B (3 free nodes, solved)
    Eigen::MatrixXd constraints;             ///< C (3 free nodes, solved)
    Eigen::VectorXd compliance;              ///< the diagonal D (solved)
    std::vector<std::string> multipliers;    ///< (solved) names for messages: cable "left"
    double wanted_residual = best_residual;  ///< target residual of solves, relative to the right-hand side

    [[nodiscard]] Eigen::Index free_size() const { return forces.rows(); }
    [[nodiscard]] Eigen::Index size() const { return forces.rows() + forces.cols(); }
    /// A v, or A^T v; (size) -> (size).
    [[nodiscard]] Eigen::VectorXd multiply(const Eigen::VectorXd& v, Side side) const;
    /// Removes the components along which rollers hold nodes from a vector (size).
    void leave_out_held(Eigen::VectorXd& v) const;
};

/// result += factor * S v for a skew matrix S of which the blocks at and below the diagonal are given, in blocks of 3.
void add_skew_product(const linalg::SymmetricPattern& pattern, const std::vector<double>& values,
                      const Eigen::VectorXd& v, double factor, Eigen::VectorXd& result);

/// Solves with a LinearSystem. Its preconditioner is the exact inverse, to rounding, of the system without the skew
/// part: a Cholesky factor of K in single precision, or two-level conjugate gradients, and the small Schur complement D
/// - C^T K^-1 B. Solutions are refined with residuals of the full system. If that fails, or K is nearly singular, it
/// solves again with a factor in double precision. Where K is not positive definite, as at an unstable equilibrium, a
/// multiple of its diagonal is added to the preconditioner until it is, and GMRES (Saad and Schultz 1986) corrects for
/// that and for the skew part. Forces and constraints are balanced first: each multiplier is scaled so that its column
/// has the magnitude of those of K.
class SystemSolver {
public:
    /// `system` must outlive it.
    explicit SystemSolver(const LinearSystem& system);
    /// For a system that has the K and B of another one's: takes over what that one has made of them.
    SystemSolver(const LinearSystem& system, SystemSolver&& other);
    ~SystemSolver();

    /// x with A x = b, or A^T x = b, to |b - A x| <= 10 |b| times the target residual, in balanced units; or, if x is
    /// so much larger than b that rounding x exceeds this, to the rounding error. With two levels to about 1e-8 of x in
    /// the norm of K, or to ten times the target, 1e-6 at best. If cables are redundant, the solution with the smallest
    /// multipliers. Errors: no solution, because redundant cables have conflicting targets; A is singular (a limit
    /// point, a bifurcation, a part that can move freely).
    [[nodiscard]] Result<Eigen::VectorXd> solve(const Eigen::VectorXd& b, Side side);
    /// The same for each column, (size, k): several cost little more than one. If only the constraints' rows differ
    /// from zero, and K is factorised, they cost little more than the products that check them.
    [[nodiscard]] Result<Eigen::MatrixXd> solve_all(const Eigen::MatrixXd& columns, Side side);

private:
    /// How K is solved with, from fastest to most robust.
    enum class Method { none, levels, single_, double_ };
    [[nodiscard]] Status prepare();
    void begin();
    [[nodiscard]] bool begin_quickly(Method method);
    [[nodiscard]] bool make_quickly(Method method);
    /// How accurate K^-1 B is: as the preconditioner, as solutions are wanted, or to nearly all digits.
    enum class Columns { none, rough, wanted, fine };
    [[nodiscard]] bool solve_columns(Columns accuracy);
    void improve_columns();
    void begin_surely();
    [[nodiscard]] linalg::Cholesky& factor(linalg::Precision precision);
    [[nodiscard]] bool factorise();
    [[nodiscard]] bool solve_body(const Eigen::MatrixXd& right, double wanted, Eigen::MatrixXd& columns) const;
    [[nodiscard]] bool apply_body(Eigen::MatrixXd& columns) const;
    [[nodiscard]] bool take_schur_complement();
    [[nodiscard]] bool take_schur_complement(Columns accuracy, double threshold);
    [[nodiscard]] bool is_far_from_singular() const;
    [[nodiscard]] bool is_content() const;
    [[nodiscard]] double level_tolerance() const;
    [[nodiscard]] double allowed_residual() const;
    [[nodiscard]] Eigen::MatrixXd balanced(const Eigen::MatrixXd& columns, Side side) const;
    [[nodiscard]] Result<Eigen::VectorXd> solve_balanced(const Eigen::VectorXd& b, Side side,
                                                         const Eigen::VectorXd* first);
    [[nodiscard]] std::optional<Eigen::VectorXd> refine(const Eigen::VectorXd& b, Side side,
                                                        const Eigen::VectorXd* first = nullptr) const;
    [[nodiscard]] Eigen::VectorXd correction(const Eigen::VectorXd& residual, double wanted, Side side) const;
    [[nodiscard]] Eigen::VectorXd multiply(const Eigen::VectorXd& v, Side side) const;
    [[nodiscard]] Eigen::MatrixXd precondition(const Eigen::MatrixXd& columns, Side side) const;
    [[nodiscard]] double rounding_of(const Eigen::VectorXd& x, Side side) const;
    [[nodiscard]] bool is_singular() const;
    void take_whole_factor();
    [[nodiscard]] Error redundancy() const;

    const LinearSystem* system_;
    Method method_ = Method::none;
    Method taken_over_ = Method::none;  ///< how the factor or the levels that were taken over solve with K
    bool singular_ = false;
    bool exact_ = false;                        ///< the preconditioner is the inverse to rounding
    double stiffness_ = 1;                      ///< mean of the diagonal of K, N/m
    Eigen::VectorXd column_, row_;              ///< (solved) scaling of the multipliers and of the constraints
    Eigen::MatrixXd forces_;                    ///< B, scaled
    Eigen::MatrixXd constraints_;               ///< C, scaled
    Eigen::VectorXd compliance_;                ///< D, scaled
    std::unique_ptr<linalg::Cholesky> factor_;  ///< of K, or of K with its diagonal increased
    std::unique_ptr<linalg::TwoLevel> levels_;  ///< of K
    Eigen::MatrixXd from_forces_;               ///< K^-1 B,
    Columns accuracy_ = Columns::none;          ///< and how accurate that is
    Eigen::MatrixXd from_constraints_;          ///< K^-1 C
    Eigen::MatrixXd schur_inverse_;             ///< of D - C^T K^-1 B, or the pseudo-inverse
    Eigen::MatrixXd schur_null_;                ///< columns: combinations of multipliers without effect
    struct WholeFactor;
    std::shared_ptr<WholeFactor> whole_;  ///< of A, balanced, for when GMRES with the others fails
};

}  // namespace pliant::sim
