// Energy, stress and stiffness at one point of several tets at once, for the laws in the invariants of F.
//
// With F = sum_a x_a (grad N_a)^T, G = dJ/dF (the cofactor), E = dI2/dF = 2 (I1 F - F C), s = J^(-2/3) and
// W(I1_bar, I2_bar) + U(J) the energy, the stress is P = p_F F + p_E E + p_G G. The stiffness of two nodes with
// gradients a, b is d(P a)/d(u) for dF = u b^T, which needs only the vectors F a, E a, G a of each node:
//   dF a        = (a.b) u
//   d(G) a      = (G a (G b)^T - G b (G a)^T) u / J
//   d(E) a      = 2 (2 F a (F b)^T - F b (F a)^T + (I1 (a.b) - F a . F b) I - (a.b) F F^T) u
// and the second derivatives of the energy with respect to I1, I2 and J multiply the outer products of these vectors.
#if defined(PLIANT_SIM_ELEMENT_POINT_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef PLIANT_SIM_ELEMENT_POINT_INL_HPP
#undef PLIANT_SIM_ELEMENT_POINT_INL_HPP
#else
#define PLIANT_SIM_ELEMENT_POINT_INL_HPP
#endif

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include "simulation/elements/element_sums-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pliant::sim::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Quantities at one point that stress and stiffness share. `second`: the law depends on I2.
template <bool second>
struct Point {
    Matrix F, G, E;
    V J, I1, I2, s;
    V x;   ///< I1_bar - 3
    V W1;  ///< dW / dI1_bar

    HWY_INLINE void set_shape(const Matrix& deformation) {
        F = deformation;
        G = cofactor(F);
        J = determinant_by(F, G);
    }
    HWY_INLINE void set_law(const material::InvariantForm& law) {
        const Tag d;
        I1 = hn::Zero(d);
        for (const auto& column : F.m) {
            for (const V& entry : column) I1 = hn::MulAdd(entry, entry, I1);
        }
        s = hn::Exp(d, hn::Mul(set(-2.0 / 3), hn::Log(d, J)));
        x = hn::MulSub(s, I1, set(3));
        W1 = hn::MulAdd(x, hn::MulAdd(x, set(3 * law.c30_Pa), set(2 * law.c20_Pa)), set(law.c10_Pa));
        if constexpr (second) {
            const Matrix C = right_cauchy(F);
            V squares = hn::Zero(d);
            for (const auto& column : C.m) {
                for (const V& entry : column) squares = hn::MulAdd(entry, entry, squares);
            }
            I2 = hn::Mul(set(0.5), hn::MulSub(I1, I1, squares));
            for (int j = 0; j < 3; ++j) {
                for (int i = 0; i < 3; ++i) {
                    V sum = hn::Mul(I1, F.m[j][i]);
                    for (int k = 0; k < 3; ++k) sum = hn::NegMulAdd(F.m[k][i], C.m[j][k], sum);
                    E.m[j][i] = hn::Add(sum, sum);
                }
            }
        }
    }
    [[nodiscard]] HWY_INLINE V add_energy(const material::InvariantForm& law, V volume, V sum) const {
        const V grown = hn::Sub(J, set(1));
        V psi = hn::Mul(x, hn::MulAdd(x, hn::MulAdd(x, set(law.c30_Pa), set(law.c20_Pa)), set(law.c10_Pa)));
        if constexpr (second) psi = hn::MulAdd(set(law.c01_Pa), hn::MulSub(hn::Mul(s, s), I2, set(3)), psi);
        return hn::MulAdd(volume, hn::MulAdd(hn::Mul(set(0.5 * law.bulk_Pa), grown), grown, psi), sum);
    }
    /// p_F, p_E, p_G.
    [[nodiscard]] HWY_INLINE V along_F() const { return hn::Mul(hn::Add(W1, W1), s); }
    [[nodiscard]] HWY_INLINE V along_E(const material::InvariantForm& law) const {
        return hn::Mul(set(law.c01_Pa), hn::Mul(s, s));
    }
    [[nodiscard]] HWY_INLINE V along_G(const material::InvariantForm& law) const {
        V sum = hn::Mul(set(2.0 / 3), hn::Mul(W1, hn::Mul(s, I1)));
        if constexpr (second) sum = hn::MulAdd(set(4.0 / 3), hn::Mul(along_E(law), I2), sum);
        return hn::MulSub(set(law.bulk_Pa), hn::Sub(J, set(1)), hn::Div(sum, J));
    }
    [[nodiscard]] HWY_INLINE Matrix stress(const material::InvariantForm& law, V volume) const {
        const V of_F = hn::Mul(volume, along_F());
        const V of_G = hn::Mul(volume, along_G(law));
        Matrix P;
        for (int j = 0; j < 3; ++j) {
            for (int i = 0; i < 3; ++i) P.m[j][i] = hn::MulAdd(of_F, F.m[j][i], hn::Mul(of_G, G.m[j][i]));
        }
        if constexpr (second) {
            const V of_E = hn::Mul(volume, along_E(law));
            for (int j = 0; j < 3; ++j) {
                for (int i = 0; i < 3; ++i) P.m[j][i] = hn::MulAdd(of_E, E.m[j][i], P.m[j][i]);
            }
        }
        return P;
    }
};

/// Coefficients of the outer products, times the volume of the point.
template <bool second>
struct Factors {
    V same;   ///< (a.b) I
    V ff;     ///< F a (F b)^T
    V fh;     ///< F a (G b)^T + G a (F b)^T
    V hh;     ///< G a (G b)^T
    V twist;  ///< G a (G b)^T - G b (G a)^T
    V second_E, eh;

    HWY_INLINE Factors(const Point<second>& p, const material::InvariantForm& law, V volume) {
        const V inverse = hn::Div(set(1), p.J);
        const V slope = hn::Mul(set(-2.0 / 3), hn::Mul(p.s, inverse));  // ds / dJ
        const V W11 = hn::MulAdd(p.x, set(6 * law.c30_Pa), set(2 * law.c20_Pa));
        same = hn::Mul(volume, p.along_F());
        ff = hn::Mul(volume, hn::Mul(set(4), hn::Mul(hn::Mul(p.s, p.s), W11)));
        fh = hn::Mul(volume, hn::Mul(set(2), hn::Mul(slope, hn::MulAdd(W11, hn::Mul(p.s, p.I1), p.W1))));
        twist = hn::Mul(volume, hn::Mul(p.along_G(law), inverse));
        const V bend = hn::Mul(set(10.0 / 9), hn::Mul(p.s, hn::Mul(inverse, inverse)));  // d2s / dJ2
        const V change = hn::Mul(p.I1, slope);
        V curvature = hn::MulAdd(hn::Mul(p.W1, p.I1), bend, set(law.bulk_Pa));
        curvature = hn::MulAdd(hn::Mul(W11, change), change, curvature);
        if constexpr (second) {
            const V along_E = p.along_E(law);
            curvature =
                hn::MulAdd(hn::Mul(along_E, p.I2), hn::Mul(set(28.0 / 9), hn::Mul(inverse, inverse)), curvature);
            second_E = hn::Mul(volume, hn::Add(along_E, along_E));
            eh = hn::Mul(volume, hn::Mul(set(-4.0 / 3), hn::Mul(along_E, inverse)));
        }
        hh = hn::Mul(volume, curvature);
    }
};

template <template <bool second> class Form, bool second>
void stiffness_by_nodes(const TetBatch& batch, const material::InvariantForm& law, const double* x, double* blocks) {
    batch.nodes_per_tet == 4 ? stiffness_of<Point<second>, Form<second>, 4>(batch, law, x, blocks)
                             : stiffness_of<Point<second>, Form<second>, 10>(batch, law, x, blocks);
}

template <template <bool second> class Form>
void stiffness(const TetBatch& batch, const material::InvariantForm& law, const double* x, double* blocks) {
    law.c01_Pa != 0 ? stiffness_by_nodes<Form, true>(batch, law, x, blocks)
                    : stiffness_by_nodes<Form, false>(batch, law, x, blocks);
}

}  // namespace pliant::sim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
