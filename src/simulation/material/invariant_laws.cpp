// Laws in the invariants of C = F^T F: Mooney-Rivlin and Yeoh.
//
// I1 = tr C, I2 = (I1^2 - tr C^2) / 2; the bars remove the change of volume: I1_bar = J^(-2/3) I1, I2_bar = J^(-4/3)
// I2.
#include <cmath>

#include "simulation/material/point.hpp"

namespace pliant::material {
namespace {

double volumetric(double bulk_Pa, double J) {
    return 0.5 * bulk_Pa * (J - 1) * (J - 1);
}

/// Quantities of F that both invariants need.
struct FirstInvariant {
    explicit FirstInvariant(const Matrix3& F)
        : J(F.determinant()), I1(F.squaredNorm()), scale(1 / std::cbrt(J * J)), C(cofactor(F)) {}
    [[nodiscard]] double bar() const { return scale * I1; }
    [[nodiscard]] Matrix3 gradient(const Matrix3& F) const { return 2 * scale * (F - I1 / (3 * J) * C); }
    /// H += w * d^2 I1_bar / dF^2 without its part along d^2 J, whose factor is returned.
    [[nodiscard]] double add_gradient2(Matrix9& H, const Matrix3& F, double w) const {
        const double s = 2 * w * scale;
        const Vector9 f = vec(F);
        const Vector9 c = vec(C);
        H += (5 * s * I1 / (9 * J * J)) * (c * c.transpose());
        H -= (2 * s / (3 * J)) * (f * c.transpose() + c * f.transpose());
        H.diagonal().array() += s;
        return -s * I1 / (3 * J);
    }

    double J, I1;
    double scale;  ///< J^(-2/3)
    Matrix3 C;     ///< cofactor
};

struct SecondInvariant {
    SecondInvariant(const Matrix3& F, const FirstInvariant& first)
        : right(F.transpose() * F),
          I2(0.5 * (first.I1 * first.I1 - right.squaredNorm())),
          scale(first.scale * first.scale),
          g(2 * (first.I1 * F - F * right)) {}
    [[nodiscard]] double bar() const { return scale * I2; }
    [[nodiscard]] Matrix3 gradient(const FirstInvariant& first) const {
        return scale * (g - 4 * I2 / (3 * first.J) * first.C);
    }
    /// As FirstInvariant::add_gradient2.
    [[nodiscard]] double add_gradient2(Matrix9& H, const Matrix3& F, const FirstInvariant& first, double w) const {
        const double t = w * scale;
        const double J = first.J;
        const Vector9 c = vec(first.C);
        const Vector9 g9 = vec(g);
        const Vector9 f = vec(F);
        H += (28 * t * I2 / (9 * J * J)) * (c * c.transpose());
        H -= (4 * t / (3 * J)) * (g9 * c.transpose() + c * g9.transpose());
        H += 4 * t * (f * f.transpose());
        H.diagonal().array() += 2 * t * first.I1;
        const Matrix3 left = F * F.transpose();
        for (int j = 0; j < 3; ++j) {
            H.block<3, 3>(3 * j, 3 * j) -= 2 * t * left;  // F F^T dF
            for (int a = 0; a < 3; ++a) {
                H.block<3, 3>(3 * j, 3 * a).diagonal().array() -= 2 * t * right(a, j);   // dF F^T F
                H.block<3, 3>(3 * j, 3 * a) -= 2 * t * F.col(a) * F.col(j).transpose();  // F dF^T F
            }
        }
        return -4 * t * I2 / (3 * J);
    }

    Matrix3 right;
    double I2;
    double scale;  ///< J^(-4/3)
    Matrix3 g;     ///< d I2 / dF
};

}  // namespace

std::optional<double> psi(const MooneyRivlin& law, const Matrix3& F) {
    const FirstInvariant first(F);
    const SecondInvariant second(F, first);
    return law.c10_Pa * (first.bar() - 3) + law.c01_Pa * (second.bar() - 3) + volumetric(law.bulk_Pa, first.J);
}

Matrix3 first_piola(const MooneyRivlin& law, const Matrix3& F) {
    const FirstInvariant first(F);
    const SecondInvariant second(F, first);
    return law.c10_Pa * first.gradient(F) + law.c01_Pa * second.gradient(first) + law.bulk_Pa * (first.J - 1) * first.C;
}

Matrix9 first_piola_gradient(const MooneyRivlin& law, const Matrix3& F) {
    const FirstInvariant first(F);
    const SecondInvariant second(F, first);
    const Vector9 c = vec(first.C);
    Matrix9 H = law.bulk_Pa * (c * c.transpose());
    double along_J = law.bulk_Pa * (first.J - 1);
    along_J += first.add_gradient2(H, F, law.c10_Pa);
    along_J += second.add_gradient2(H, F, first, law.c01_Pa);
    add_cofactor_gradient(H, F, along_J);
    return H;
}

std::optional<double> psi(const Yeoh& law, const Matrix3& F) {
    const FirstInvariant first(F);
    const double x = first.bar() - 3;
    return x * (law.c10_Pa + x * (law.c20_Pa + x * law.c30_Pa)) + volumetric(law.bulk_Pa, first.J);
}

Matrix3 first_piola(const Yeoh& law, const Matrix3& F) {
    const FirstInvariant first(F);
    const double x = first.bar() - 3;
    const double slope = law.c10_Pa + x * (2 * law.c20_Pa + x * 3 * law.c30_Pa);
    return slope * first.gradient(F) + law.bulk_Pa * (first.J - 1) * first.C;
}

Matrix9 first_piola_gradient(const Yeoh& law, const Matrix3& F) {
    const FirstInvariant first(F);
    const double x = first.bar() - 3;
    const double slope = law.c10_Pa + x * (2 * law.c20_Pa + x * 3 * law.c30_Pa);
    const Vector9 c = vec(first.C);
    const Vector9 g = vec(first.gradient(F));
    Matrix9 H = law.bulk_Pa * (c * c.transpose());
    H += (2 * law.c20_Pa + 6 * x * law.c30_Pa) * (g * g.transpose());
    const double along_J = law.bulk_Pa * (first.J - 1) + first.add_gradient2(H, F, slope);
    add_cofactor_gradient(H, F, along_J);
    return H;
}

Slopes stress_slopes(const MooneyRivlin& /*law*/, const Matrix3& F) {
    const FirstInvariant first(F);
    return {first.gradient(F), SecondInvariant(F, first).gradient(first), (first.J - 1) * first.C};
}

Slopes stress_slopes(const Yeoh& /*law*/, const Matrix3& F) {
    const FirstInvariant first(F);
    const double x = first.bar() - 3;
    const Matrix3 g = first.gradient(F);
    return {g, 2 * x * g, 3 * x * x * g, (first.J - 1) * first.C};
}

}  // namespace pliant::material
