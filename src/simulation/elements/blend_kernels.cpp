// Compiled once for each instruction set; the one that the machine has is chosen when the program runs.
//
// P = w (F - T), T = a R + b F with b = (1 - a) J^(-1/3) and the rotation R nearest to F (T3.4). Two nodes with
// gradients g, h share the block d(P g)/d(u) for dF = u h^T, of which the symmetric part is
//   w (1 - b) (g.h) I + w b/(6J) (F g (G h)^T + G g (F h)^T) + w a [R g]x Z [R h]x,    Z = (tr V I - V)^-1
// with G the cofactor of F, V = F R^T and [v]x y = v x y: as dF turns the body by dR = [r]x R, r = Z (R h x u).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simulation/elements/blend_kernels.cpp"
#include "simulation/elements/blend_kernels.hpp"

#include <hwy/foreach_target.h>
// After foreach_target, as it asks.
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include "simulation/elements/element_sums-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pliant::sim::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// The rotation nearest to F, det F > 0, by Newton's iteration (Higham 1986), which halves large stretches at first and
/// then converges quadratically.
HWY_INLINE Matrix nearest_rotation(const Matrix& F) {
    constexpr int most = 40;
    const Tag d;
    Matrix R = F;
    for (int k = 0; k < most; ++k) {
        const Matrix G = cofactor(R);
        const V share = hn::Div(set(0.5), determinant_by(R, G));
        V moved = hn::Zero(d);
        for (int j = 0; j < 3; ++j) {
            for (int i = 0; i < 3; ++i) {
                const V next = hn::MulAdd(share, G.m[j][i], hn::Mul(set(0.5), R.m[j][i]));
                moved = hn::Max(moved, hn::Abs(hn::Sub(next, R.m[j][i])));
                R.m[j][i] = next;
            }
        }
        // A change of 1e-8 leaves an error of its square.
        if (hn::AllTrue(d, hn::Lt(moved, set(1e-8)))) break;
    }
    return R;
}

/// One point: its deformation and blend.
struct Blend {
    Matrix F, G, R;
    V J;
    V soft;  ///< b

    HWY_INLINE void set_shape(const Matrix& deformation) {
        F = deformation;
        G = cofactor(F);
        J = determinant_by(F, G);
    }
    HWY_INLINE void set_law(const material::ShapeBlend& law) {
        const Tag d;
        R = nearest_rotation(F);
        soft = hn::Mul(set(1 - law.a), hn::Exp(d, hn::Mul(set(-1.0 / 3), hn::Log(d, J))));
    }
    /// F - T.
    [[nodiscard]] HWY_INLINE Matrix off(const material::ShapeBlend& law) const {
        Matrix off;
        for (int j = 0; j < 3; ++j) {
            for (int i = 0; i < 3; ++i) {
                const V target = hn::MulAdd(soft, F.m[j][i], hn::Mul(set(law.a), R.m[j][i]));
                off.m[j][i] = hn::Sub(F.m[j][i], target);
            }
        }
        return off;
    }
    /// The blend has an energy only if its soft part is zero.
    [[nodiscard]] HWY_INLINE V add_energy(const material::ShapeBlend& law, V volume, V sum) const {
        if (law.a != 1) return sum;
        V square = hn::Zero(Tag());
        const Matrix gap = off(law);
        for (const auto& column : gap.m) {
            for (const V& entry : column) square = hn::MulAdd(entry, entry, square);
        }
        return hn::MulAdd(hn::Mul(set(0.5), hn::Mul(set(law.weight_Pa), volume)), square, sum);
    }
    [[nodiscard]] HWY_INLINE Matrix stress(const material::ShapeBlend& law, V volume) const {
        const V weight = hn::Mul(set(law.weight_Pa), volume);
        Matrix P = off(law);
        for (auto& column : P.m) {
            for (V& entry : column) entry = hn::Mul(weight, entry);
        }
        return P;
    }
};

HWY_INLINE Matrix inverse_of(const Matrix& A) {
    const Matrix G = cofactor(A);
    const V share = hn::Div(set(1), determinant_by(A, G));
    Matrix result;
    for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) result.m[j][i] = hn::Mul(share, G.m[i][j]);
    }
    return result;
}

HWY_INLINE Vector cross_of(const Vector& a, const Vector& b) {
    Vector c;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        const int k = (i + 2) % 3;
        c.v[i] = hn::MulSub(a.v[j], b.v[k], hn::Mul(a.v[k], b.v[j]));
    }
    return c;
}

/// The symmetric part of the stiffness of one point.
struct BlendTangent {
    struct OfNode {
        Vector g, f, h;  ///< a gradient g, F g, G g
        Vector r;        ///< R g
        Matrix turned;   ///< Z [R g]x
    };
    Blend p;
    Matrix Z;
    V straight, mixed, turning;

    HWY_INLINE BlendTangent(const Blend& point, const material::ShapeBlend& law, V volume) : p(point) {
        const V weight = hn::Mul(set(law.weight_Pa), volume);
        straight = hn::Mul(weight, hn::Sub(set(1), p.soft));
        mixed = hn::Mul(weight, hn::Div(p.soft, hn::Mul(set(6), p.J)));
        turning = hn::Mul(weight, set(law.a));
        Matrix rest;  // tr V I - V
        for (int j = 0; j < 3; ++j) {
            for (int i = 0; i < 3; ++i) {
                V entry = hn::Zero(Tag());
                for (int k = 0; k < 3; ++k) entry = hn::NegMulAdd(p.F.m[k][i], p.R.m[k][j], entry);
                rest.m[j][i] = entry;
            }
        }
        const V trace = hn::Neg(hn::Add(hn::Add(rest.m[0][0], rest.m[1][1]), rest.m[2][2]));
        for (int i = 0; i < 3; ++i) rest.m[i][i] = hn::Add(rest.m[i][i], trace);
        Z = inverse_of(rest);
    }
    [[nodiscard]] HWY_INLINE OfNode of_node(const Vector& g) const {
        OfNode node{g, times(p.F, g), times(p.G, g), times(p.R, g), {}};
        for (int c = 0; c < 3; ++c) {
            Vector unit{{hn::Zero(Tag()), hn::Zero(Tag()), hn::Zero(Tag())}};
            unit.v[c] = set(1);
            const Vector column = times(Z, cross_of(node.r, unit));
            for (int i = 0; i < 3; ++i) node.turned.m[c][i] = column.v[i];
        }
        return node;
    }
    HWY_INLINE void add_pair(const OfNode& a, const OfNode& b, V (*block)[3]) const {
        const V diagonal = hn::Mul(straight, dot(a.g, b.g));
        for (int c = 0; c < 3; ++c) {
            const Vector turn = cross_of(a.r, {{b.turned.m[c][0], b.turned.m[c][1], b.turned.m[c][2]}});
            for (int r = 0; r < 3; ++r) {
                const V outer = hn::MulAdd(a.f.v[r], b.h.v[c], hn::Mul(a.h.v[r], b.f.v[c]));
                V entry = hn::MulAdd(mixed, outer, hn::MulAdd(turning, turn.v[r], block[c][r]));
                if (r == c) entry = hn::Add(entry, diagonal);
                block[c][r] = entry;
            }
        }
    }
};

BatchResult blend_forces(const TetBatch& batch, const material::ShapeBlend& law, const double* x, double* forces) {
    return batch.nodes_per_tet == 4 ? forces_of<Blend, 4>(batch, law, x, forces)
                                    : forces_of<Blend, 10>(batch, law, x, forces);
}

void blend_stiffness(const TetBatch& batch, const material::ShapeBlend& law, const double* x, double* blocks) {
    batch.nodes_per_tet == 4 ? stiffness_of<Blend, BlendTangent, 4>(batch, law, x, blocks)
                             : stiffness_of<Blend, BlendTangent, 10>(batch, law, x, blocks);
}

}  // namespace pliant::sim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pliant::sim {

HWY_EXPORT(blend_forces);
HWY_EXPORT(blend_stiffness);

BatchResult batch_blend_forces(const TetBatch& batch, const material::ShapeBlend& law, const double* x,
                               double* forces) {
    return HWY_DYNAMIC_DISPATCH(blend_forces)(batch, law, x, forces);
}

void batch_blend_tangent(const TetBatch& batch, const material::ShapeBlend& law, const double* x, double* blocks) {
    HWY_DYNAMIC_DISPATCH(blend_stiffness)(batch, law, x, blocks);
}

}  // namespace pliant::sim
#endif
