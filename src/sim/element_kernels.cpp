// Compiled once for each instruction set; the one that the machine has is chosen when the program runs.
//
// With F = sum_a x_a (grad N_a)^T, G = dJ/dF (the cofactor), E = dI2/dF = 2 (I1 F - F C), s = J^(-2/3) and
// W(I1_bar, I2_bar) + U(J) the energy, the stress is P = p_F F + p_E E + p_G G. The stiffness of two nodes with
// gradients a, b is d(P a)/d(u) for dF = u b^T, which needs only the vectors F a, E a, G a of each node:
//   dF a        = (a.b) u
//   d(G) a      = (G a (G b)^T - G b (G a)^T) u / J
//   d(E) a      = 2 (2 F a (F b)^T - F b (F a)^T + (I1 (a.b) - F a . F b) I - (a.b) F F^T) u
// and the second derivatives of the energy with respect to I1, I2 and J multiply the outer products of these vectors.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sim/element_kernels.cpp"
#include "sim/element_kernels.hpp"

#include <hwy/foreach_target.h>
// After foreach_target, as it asks.
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include <algorithm>
#include <limits>

#include "sim/element_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pliant::sim::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Everything that stress and stiffness have in common at one point. `second`: the law knows I2.
template <bool second>
struct Point {
    Matrix F, G, E;
    V J, I1, I2, s;
    V x;   ///< I1_bar - 3
    V W1;  ///< dW / dI1_bar

    HWY_INLINE void set_shape(const Matrix& deformation) {
        F = deformation;
        G = cofactor(F);
        J = hn::MulAdd(F.m[0][2], G.m[0][2], hn::MulAdd(F.m[0][1], G.m[0][1], hn::Mul(F.m[0][0], G.m[0][0])));
    }
    HWY_INLINE void set_invariants(const material::InvariantForm& law) {
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
    [[nodiscard]] HWY_INLINE V energy(const material::InvariantForm& law) const {
        const V volume = hn::Sub(J, set(1));
        V psi = hn::Mul(x, hn::MulAdd(x, hn::MulAdd(x, set(law.c30_Pa), set(law.c20_Pa)), set(law.c10_Pa)));
        if constexpr (second) psi = hn::MulAdd(set(law.c01_Pa), hn::MulSub(hn::Mul(s, s), I2, set(3)), psi);
        return hn::MulAdd(hn::Mul(set(0.5 * law.bulk_Pa), volume), volume, psi);
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
};

template <int nodes, bool second>
BatchResult forces_of(const TetBatch& batch, const material::InvariantForm& law, const double* x, double* forces) {
    const Tag d;
    constexpr int N = static_cast<int>(hn::MaxLanes(Tag()));
    HWY_ALIGN double energies[batch_lanes] = {};
    double min_J = std::numeric_limits<double>::infinity();
    for (int part = 0; part < batch_lanes; part += N) {
        V positions[nodes][3];
        load_positions<nodes>(batch, x, part, positions);
        V sum[nodes][3];
        for (auto& row : sum) {
            for (V& entry : row) entry = hn::Zero(d);
        }
        V energy = hn::Zero(d);
        for (int q = 0; q < batch.points; ++q) {
            Point<second> point;
            point.set_shape(deformation_gradient<nodes>(batch, q, part, positions));
            // Written so that a NaN counts as inside out.
            if (!hn::AllTrue(d, hn::Gt(point.J, hn::Zero(d)))) return {0, -1};
            min_J = std::min(min_J, hn::GetLane(hn::MinOfLanes(d, point.J)));
            point.set_invariants(law);
            const V volume = hn::Load(d, batch.volumes + q * batch_lanes + part);
            energy = hn::MulAdd(volume, point.energy(law), energy);
            if (forces == nullptr) continue;
            const V along_F = hn::Mul(volume, point.along_F());
            const V along_G = hn::Mul(volume, point.along_G(law));
            Matrix P;
            for (int j = 0; j < 3; ++j) {
                for (int i = 0; i < 3; ++i)
                    P.m[j][i] = hn::MulAdd(along_F, point.F.m[j][i], hn::Mul(along_G, point.G.m[j][i]));
            }
            if constexpr (second) {
                const V along_E = hn::Mul(volume, point.along_E(law));
                for (int j = 0; j < 3; ++j) {
                    for (int i = 0; i < 3; ++i) P.m[j][i] = hn::MulAdd(along_E, point.E.m[j][i], P.m[j][i]);
                }
            }
            for (int a = 0; a < nodes; ++a) {
                const Vector f = times(P, gradient(batch, q, a, part));
                for (int k = 0; k < 3; ++k) sum[a][k] = hn::Add(sum[a][k], f.v[k]);
            }
        }
        hn::Store(energy, d, energies + part);
        for (int a = 0; forces != nullptr && a < nodes; ++a) {
            for (int k = 0; k < 3; ++k) hn::Store(sum[a][k], d, forces + (3 * a + k) * batch_lanes + part);
        }
    }
    BatchResult result{0, min_J};
    for (const double energy : energies) result.energy_J += energy;
    return result;
}

/// Factors of the outer products, with the volume of the point.
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

/// What node vectors of one point add to the block of nodes a and b, by columns.
template <bool second>
HWY_INLINE void add_pair(const Factors<second>& k, const Point<second>& p, const Matrix& left, const Vector& ga,
                         const Vector& gb, const Vector& fa, const Vector& fb, const Vector& ha, const Vector& hb,
                         const Vector& ea, const Vector& eb, V (*block)[3]) {
    const V gab = dot(ga, gb);
    V diagonal = hn::Mul(k.same, gab);
    V ff = k.ff;
    if constexpr (second) {
        diagonal = hn::MulAdd(k.second_E, hn::MulSub(p.I1, gab, dot(fa, fb)), diagonal);
        ff = hn::MulAdd(set(2), k.second_E, ff);
    }
    const V straight = hn::Add(k.hh, k.twist);
    for (int c = 0; c < 3; ++c) {
        const V of_f = hn::MulAdd(ff, fb.v[c], hn::Mul(k.fh, hb.v[c]));
        V of_h = hn::MulAdd(k.fh, fb.v[c], hn::Mul(straight, hb.v[c]));
        if constexpr (second) of_h = hn::MulAdd(k.eh, eb.v[c], of_h);
        const V of_hb = hn::Mul(k.twist, ha.v[c]);
        for (int r = 0; r < 3; ++r) {
            V entry = hn::MulAdd(fa.v[r], of_f, hn::MulAdd(ha.v[r], of_h, block[c][r]));
            entry = hn::NegMulAdd(hb.v[r], of_hb, entry);
            if constexpr (second) {
                entry = hn::MulAdd(ea.v[r], hn::Mul(k.eh, hb.v[c]), entry);
                const V mixed = hn::MulAdd(fb.v[r], fa.v[c], hn::Mul(gab, left.m[c][r]));
                entry = hn::NegMulAdd(k.second_E, mixed, entry);
            }
            block[c][r] = r == c ? hn::Add(entry, diagonal) : entry;
        }
    }
}

template <int nodes, bool second>
void tangent_of(const TetBatch& batch, const material::InvariantForm& law, const double* x, double* blocks) {
    const Tag d;
    constexpr int N = static_cast<int>(hn::MaxLanes(Tag()));
    for (int part = 0; part < batch_lanes; part += N) {
        V positions[nodes][3];
        load_positions<nodes>(batch, x, part, positions);
        for (int q = 0; q < batch.points; ++q) {
            Point<second> point;
            point.set_shape(deformation_gradient<nodes>(batch, q, part, positions));
            point.set_invariants(law);
            const Factors<second> factors(point, law, hn::Load(d, batch.volumes + q * batch_lanes + part));
            Vector g[nodes], f[nodes], h[nodes], e[nodes];
            Matrix left{};
            if constexpr (second) left = left_cauchy(point.F);
            for (int a = 0; a < nodes; ++a) {
                g[a] = gradient(batch, q, a, part);
                f[a] = times(point.F, g[a]);
                h[a] = times(point.G, g[a]);
                if constexpr (second) e[a] = times(point.E, g[a]);
            }
            double* out = blocks + part;
            for (int b = 0; b < nodes; ++b) {
                for (int a = 0; a <= b; ++a, out += 9 * batch_lanes) {
                    V block[3][3];
                    for (int k = 0; k < 9; ++k)
                        block[k / 3][k % 3] = q == 0 ? hn::Zero(d) : hn::Load(d, out + k * batch_lanes);
                    add_pair(factors, point, left, g[a], g[b], f[a], f[b], h[a], h[b], e[a], e[b], block);
                    for (int k = 0; k < 9; ++k) hn::Store(block[k / 3][k % 3], d, out + k * batch_lanes);
                }
            }
        }
    }
}

BatchResult forces(const TetBatch& batch, const material::InvariantForm& law, const double* x, double* result) {
    const bool second = law.c01_Pa != 0;
    if (batch.nodes_per_tet == 4)
        return second ? forces_of<4, true>(batch, law, x, result) : forces_of<4, false>(batch, law, x, result);
    return second ? forces_of<10, true>(batch, law, x, result) : forces_of<10, false>(batch, law, x, result);
}

void tangent(const TetBatch& batch, const material::InvariantForm& law, const double* x, double* blocks) {
    const bool second = law.c01_Pa != 0;
    if (batch.nodes_per_tet == 4)
        second ? tangent_of<4, true>(batch, law, x, blocks) : tangent_of<4, false>(batch, law, x, blocks);
    else
        second ? tangent_of<10, true>(batch, law, x, blocks) : tangent_of<10, false>(batch, law, x, blocks);
}

}  // namespace pliant::sim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pliant::sim {

HWY_EXPORT(forces);
HWY_EXPORT(tangent);

BatchResult batch_forces(const TetBatch& batch, const material::InvariantForm& law, const double* x, double* result) {
    return HWY_DYNAMIC_DISPATCH(forces)(batch, law, x, result);
}

void batch_tangent(const TetBatch& batch, const material::InvariantForm& law, const double* x, double* blocks) {
    HWY_DYNAMIC_DISPATCH(tangent)(batch, law, x, blocks);
}

}  // namespace pliant::sim
#endif
