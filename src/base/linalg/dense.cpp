#include "base/linalg/dense.hpp"

#include <Eigen/Dense>

namespace pliant::linalg {

using Eigen::MatrixXd;
using Eigen::VectorXd;

Eigenpairs symmetric_eigenpairs(const MatrixXd& matrix) {
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(matrix);
    return {eigen.eigenvalues(), eigen.eigenvectors()};
}

std::optional<Eigenpairs> generalized_eigenpairs(const MatrixXd& K, const MatrixXd& M) {
    if (M.llt().info() != Eigen::Success) return std::nullopt;  // Eigen does not look
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> eigen(K, M);
    if (eigen.info() != Eigen::Success) return std::nullopt;
    return Eigenpairs{eigen.eigenvalues(), eigen.eigenvectors()};
}

MatrixXd positive_part(const MatrixXd& symmetric) {
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(symmetric);
    return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() * eigen.eigenvectors().transpose();
}

Svd svd(const MatrixXd& A, SvdParts parts) {
    unsigned wanted = 0;
    if (parts == SvdParts::thin_left) wanted = Eigen::ComputeThinU;
    if (parts == SvdParts::square_right) wanted = Eigen::ComputeFullV;
    if (parts == SvdParts::square) wanted = Eigen::ComputeFullU | Eigen::ComputeFullV;
    const Eigen::JacobiSVD<MatrixXd> found(A, wanted);
    Svd result{{}, found.singularValues(), {}};
    if (found.computeU()) result.U = found.matrixU();
    if (found.computeV()) result.V = found.matrixV();
    return result;
}

std::optional<VectorXd> positive_solution(const MatrixXd& A, const VectorXd& b) {
    const Eigen::LLT<MatrixXd> llt(A);
    if (llt.info() != Eigen::Success) return std::nullopt;
    return llt.solve(b);
}

std::optional<MatrixXd> positive_inverse(const MatrixXd& A) {
    const Eigen::LLT<MatrixXd> llt(A);
    if (llt.info() != Eigen::Success) return std::nullopt;
    return llt.solve(MatrixXd::Identity(A.rows(), A.cols()));
}

VectorXd least_squares(const MatrixXd& A, const VectorXd& b) {
    return A.colPivHouseholderQr().solve(b);
}

std::optional<VectorXd> unique_least_squares(const MatrixXd& A, const VectorXd& b) {
    const Eigen::ColPivHouseholderQR<MatrixXd> qr(A);
    if (qr.rank() < A.cols()) return std::nullopt;
    return qr.solve(b);
}

VectorXd shortest_least_squares(const MatrixXd& A, const VectorXd& b) {
    return A.completeOrthogonalDecomposition().solve(b);
}

PseudoInverse pseudo_inverse_and_rank(const MatrixXd& A, std::optional<double> threshold) {
    Eigen::CompleteOrthogonalDecomposition<MatrixXd> decomposition(A.rows(), A.cols());
    if (threshold) decomposition.setThreshold(*threshold);
    decomposition.compute(A);
    return {decomposition.pseudoInverse(), decomposition.rank()};
}

MatrixXd pseudo_inverse(const MatrixXd& A, std::optional<double> threshold) {
    return pseudo_inverse_and_rank(A, threshold).inverse;
}

MatrixXd column_basis(const MatrixXd& A, double threshold) {
    Eigen::ColPivHouseholderQR<MatrixXd> qr(A);
    qr.setThreshold(threshold);
    return qr.householderQ() * MatrixXd::Identity(A.rows(), qr.rank());
}

}  // namespace pliant::linalg
