// Ogden's law, in principal stretches.
//
// With F = U diag(l) V^T and psi a symmetric function of l, P = U diag(p) V^T with p_i = d psi / d l_i. In the frames U
// and V the tangent couples the diagonal entries by d p_i / d l_j, and each pair of off-diagonal entries by (p_i - p_j)
// / (l_i - l_j) and (p_i + p_j) / (l_i + l_j). Ogden, Non-Linear Elastic Deformations (1984), section 6.1. With q_i =
// l_i p_i the first quotient is ((q_i - q_j) / (l_i - l_j) - q_j / l_j) / l_i, which leaves only differences of powers
// of stretches; power_quotient computes these without cancellation for equal or nearly equal stretches.
#include <cmath>

#include "simulation/material/point.hpp"

namespace pliant::material {
namespace {

using linalg::Vector3;

/// (x^a - y^a) / (x - y), also for x = y.
double power_quotient(double x, double y, double a) {
    const double difference = x - y;
    if (difference == 0) return a * std::pow(y, a - 1);
    return std::pow(y, a) * std::expm1(a * std::log1p(difference / y)) / difference;
}

/// l_bar_i^a = J^(-a/3) l_i^a.
Vector3 powers(const Vector3& l, double J, double a) {
    return (l.array() / std::cbrt(J)).pow(a);
}

/// q_i = l_i d psi / d l_i.
Vector3 scaled_forces(const Ogden& law, const Vector3& l, double J) {
    Vector3 q = Vector3::Constant(law.bulk_Pa * (J - 1) * J);
    for (int k = 0; k < law.terms; ++k) {
        const Vector3 power = powers(l, J, law.alpha[k]);
        q.array() += 2 * law.mu_Pa[k] / law.alpha[k] * (power.array() - power.mean());
    }
    return q;
}

/// d^2 psi / dl_i dl_j.
Matrix3 principal_gradient(const Ogden& law, const Vector3& l, const Vector3& q, double J) {
    Matrix3 D = Matrix3::Constant(law.bulk_Pa * (2 * J - 1) * J);  // l_j d q_i / d l_j
    for (int k = 0; k < law.terms; ++k) {
        const Vector3 power = powers(l, J, law.alpha[k]);
        const double mean = power.mean();
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                const double own = i == j ? power[i] : 0;
                D(i, j) += 2 * law.mu_Pa[k] * (own - (power[i] + power[j]) / 3 + mean / 3);
            }
        }
    }
    D.diagonal() -= q;
    return l.cwiseInverse().asDiagonal() * D * l.cwiseInverse().asDiagonal();
}

/// (p_i - p_j) / (l_i - l_j).
double force_quotient(const Ogden& law, const Vector3& l, const Vector3& q, double J, int i, int j) {
    double quotient = 0;
    for (int k = 0; k < law.terms; ++k) {
        const double a = law.alpha[k];
        quotient += 2 * law.mu_Pa[k] / a * std::pow(J, -a / 3) * power_quotient(l[i], l[j], a);
    }
    return (quotient - q[j] / l[j]) / l[i];
}

}  // namespace

std::optional<double> psi(const Ogden& law, const Matrix3& F) {
    const double J = F.determinant();
    const Vector3 l = linalg::signed_svd(F).sigma;
    double sum = 0.5 * law.bulk_Pa * (J - 1) * (J - 1);
    for (int k = 0; k < law.terms; ++k) {
        const double a = law.alpha[k];
        sum += 2 * law.mu_Pa[k] / (a * a) * (powers(l, J, a).sum() - 3);
    }
    return sum;
}

Matrix3 first_piola(const Ogden& law, const Matrix3& F) {
    const linalg::Svd3 svd = linalg::signed_svd(F);
    const Vector3 q = scaled_forces(law, svd.sigma, svd.sigma.prod());
    return svd.U * q.cwiseQuotient(svd.sigma).asDiagonal() * svd.V.transpose();
}

Matrix9 first_piola_gradient(const Ogden& law, const Matrix3& F) {
    const linalg::Svd3 svd = linalg::signed_svd(F);
    const Vector3& l = svd.sigma;
    const double J = l.prod();
    const Vector3 q = scaled_forces(law, l, J);
    const Matrix3 D = principal_gradient(law, l, q, J);
    Matrix9 local = Matrix9::Zero();  // of the entries (i, j) of U^T F V, at i + 3j
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) local(4 * i, 4 * j) = D(i, j);
    }
    for (int i = 0; i < 3; ++i) {
        for (int j = i + 1; j < 3; ++j) {
            const double stretch = force_quotient(law, l, q, J, i, j);
            const double spin = (q[i] / l[i] + q[j] / l[j]) / (l[i] + l[j]);
            const int ij = i + 3 * j;
            const int ji = j + 3 * i;
            local(ij, ij) = local(ji, ji) = (stretch + spin) / 2;
            local(ij, ji) = local(ji, ij) = (stretch - spin) / 2;
        }
    }
    Matrix9 frame;  // vec(U A V^T) = frame vec(A)
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) frame.block<3, 3>(3 * i, 3 * j) = svd.V(i, j) * svd.U;
    }
    return frame * local * frame.transpose();
}

/// For each term: mu, then alpha; finally the bulk modulus.
Slopes stress_slopes(const Ogden& law, const Matrix3& F) {
    const linalg::Svd3 svd = linalg::signed_svd(F);
    const double J = svd.sigma.prod();
    const auto stress_of = [&](const Vector3& q) -> Matrix3 {
        return svd.U * q.cwiseQuotient(svd.sigma).asDiagonal() * svd.V.transpose();
    };
    Slopes slopes;
    for (int k = 0; k < law.terms; ++k) {
        const double a = law.alpha[k];
        const Vector3 power = powers(svd.sigma, J, a);
        const Vector3 rate = power.array() * (svd.sigma.array() / std::cbrt(J)).log();  // of the powers with respect to
                                                                                        // alpha
        const Vector3 off = power.array() - power.mean();
        const Vector3 change = rate.array() - rate.mean();
        slopes.push_back(stress_of(2 / a * off));
        slopes.push_back(stress_of(2 * law.mu_Pa[k] / a * (change - off / a)));
    }
    slopes.push_back(stress_of(Vector3::Constant((J - 1) * J)));
    return slopes;
}

}  // namespace pliant::material
