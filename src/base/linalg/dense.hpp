// Decompositions of small matrices of any size. Eigen's templates for them take the compiler many seconds in each file
// that uses them, so they are compiled once, here.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace pliant::linalg {

struct Eigenpairs {
    Eigen::VectorXd values;   ///< ascending
    Eigen::MatrixXd vectors;  ///< a column each
};
/// Of a symmetric matrix, of which the lower triangle is read; the vectors are orthonormal.
[[nodiscard]] Eigenpairs symmetric_eigenpairs(const Eigen::MatrixXd& matrix);
/// K v = value M v, the vectors orthonormal in M. Empty if M is not positive definite.
[[nodiscard]] std::optional<Eigenpairs> generalized_eigenpairs(const Eigen::MatrixXd& K, const Eigen::MatrixXd& M);

/// The nearest positive semi-definite matrix to a symmetric one.
[[nodiscard]] Eigen::MatrixXd positive_part(const Eigen::MatrixXd& symmetric);

struct Svd {
    Eigen::MatrixXd U;
    Eigen::VectorXd sigma;  ///< descending
    Eigen::MatrixXd V;
};
enum class SvdParts {
    values,        ///< U and V are empty
    thin_left,     ///< V is empty, U has as many columns as there are values
    square_right,  ///< U is empty, V is square
    square,        ///< both are square
};
/// A = U diag(sigma) V^T.
[[nodiscard]] Svd svd(const Eigen::MatrixXd& A, SvdParts parts);

/// A^-1 b of a symmetric positive definite matrix, of which the lower triangle is read; empty if it is none.
[[nodiscard]] std::optional<Eigen::VectorXd> positive_solution(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
/// A^-1, likewise.
[[nodiscard]] std::optional<Eigen::MatrixXd> positive_inverse(const Eigen::MatrixXd& A);

/// The x that minimises |A x - b|. Where columns are linearly dependent, some unknowns are zero.
[[nodiscard]] Eigen::VectorXd least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
/// The same, but empty where columns are linearly dependent.
[[nodiscard]] std::optional<Eigen::VectorXd> unique_least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
/// The shortest x of those that minimise |A x - b|.
[[nodiscard]] Eigen::VectorXd shortest_least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);
/// Pivots below `threshold` of the largest count as zero; without it, those that are within rounding.
[[nodiscard]] Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& A, std::optional<double> threshold = {});
struct PseudoInverse {
    Eigen::MatrixXd inverse;
    Eigen::Index rank;
};
[[nodiscard]] PseudoInverse pseudo_inverse_and_rank(const Eigen::MatrixXd& A, std::optional<double> threshold = {});

/// Orthonormal columns that span those of A; what sticks out by less than `threshold` of the longest is left out.
[[nodiscard]] Eigen::MatrixXd column_basis(const Eigen::MatrixXd& A, double threshold);

}  // namespace pliant::linalg
