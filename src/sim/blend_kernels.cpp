// Compiled once for each instruction set; the one that the machine has is chosen when the program runs.
//
// P = w (F - T), T = a R + b F with b = (1 - a) J^(-1/3) and the rotation R nearest to F (T3.4). Two nodes with
// gradients g, h share the block d(P g)/d(u) for dF = u h^T, of which the symmetric part is
//   w (1 - b) (g.h) I + w b/(6J) (F g (G h)^T + G g (F h)^T) + w a [R g]x Z [R h]x,    Z = (tr V I - V)^-1
// with G the cofactor of F, V = F R^T and [v]x y = v x y: as dF turns the body by dR = [r]x R, r = Z (R h x u).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sim/blend_kernels.cpp"
#include "sim/blend_kernels.hpp"

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

/// Of F with the cofactors G.
HWY_INLINE V determinant_by(const Matrix& F, const Matrix& G) {
    return hn::MulAdd(F.m[0][2], G.m[0][2], hn::MulAdd(F.m[0][1], G.m[0][1], hn::Mul(F.m[0][0], G.m[0][0])));
}

/// The rotation nearest to F, det F > 0, by Newton's iteration (Higham 1986), which halves a large stretch at first and
/// then doubles its digits.
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
        // What moved by 1e-8 is off by its square.
        if (hn::AllTrue(d, hn::Lt(moved, set(1e-8)))) break;
    }
    return R;
}

/// One point: its shape and what blends it.
struct Blend {
    Matrix F, G, R;
    V J;
    V soft;  ///< b

    HWY_INLINE void set_shape(const Matrix& deformation) {
        F = deformation;
        G = cofactor(F);
        J = determinant_by(F, G);
    }
    HWY_INLINE void set_target(double a) {
        const Tag d;
        R = nearest_rotation(F);
        soft = hn::Mul(set(1 - a), hn::Exp(d, hn::Mul(set(-1.0 / 3), hn::Log(d, J))));
    }
};

template <int nodes>
BatchResult blend_forces_of(const TetBatch& batch, const material::ShapeBlend& law, const double* x, double* forces) {
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
            Blend point;
            point.set_shape(deformation_gradient<nodes>(batch, q, part, positions));
            // Written so that a NaN counts as inside out.
            if (!hn::AllTrue(d, hn::Gt(point.J, hn::Zero(d)))) return {0, -1};
            min_J = std::min(min_J, hn::GetLane(hn::MinOfLanes(d, point.J)));
            point.set_target(law.a);
            const V weight = hn::Mul(set(law.weight_Pa), hn::Load(d, batch.volumes + q * batch_lanes + part));
            Matrix P;
            V square = hn::Zero(d);
            for (int j = 0; j < 3; ++j) {
                for (int i = 0; i < 3; ++i) {
                    const V target = hn::MulAdd(point.soft, point.F.m[j][i], hn::Mul(set(law.a), point.R.m[j][i]));
                    const V off = hn::Sub(point.F.m[j][i], target);
                    square = hn::MulAdd(off, off, square);
                    P.m[j][i] = hn::Mul(weight, off);
                }
            }
            if (law.a == 1) energy = hn::MulAdd(hn::Mul(set(0.5), weight), square, energy);
            if (forces == nullptr) continue;
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

template <int nodes>
void blend_stiffness_of(const TetBatch& batch, const material::ShapeBlend& law, const double* x, double* blocks) {
    const Tag d;
    constexpr int N = static_cast<int>(hn::MaxLanes(Tag()));
    for (int part = 0; part < batch_lanes; part += N) {
        V positions[nodes][3];
        load_positions<nodes>(batch, x, part, positions);
        for (int q = 0; q < batch.points; ++q) {
            Blend point;
            point.set_shape(deformation_gradient<nodes>(batch, q, part, positions));
            point.set_target(law.a);
            const BlendTangent tangent(point, law, hn::Load(d, batch.volumes + q * batch_lanes + part));
            BlendTangent::OfNode node[nodes];
            for (int a = 0; a < nodes; ++a) node[a] = tangent.of_node(gradient(batch, q, a, part));
            double* out = blocks + part;
            for (int b = 0; b < nodes; ++b) {
                for (int a = 0; a <= b; ++a, out += 9 * batch_lanes) {
                    V block[3][3];
                    for (int k = 0; k < 9; ++k)
                        block[k / 3][k % 3] = q == 0 ? hn::Zero(d) : hn::Load(d, out + k * batch_lanes);
                    tangent.add_pair(node[a], node[b], block);
                    for (int k = 0; k < 9; ++k) hn::Store(block[k / 3][k % 3], d, out + k * batch_lanes);
                }
            }
        }
    }
}

BatchResult blend_forces(const TetBatch& batch, const material::ShapeBlend& law, const double* x, double* forces) {
    return batch.nodes_per_tet == 4 ? blend_forces_of<4>(batch, law, x, forces)
                                    : blend_forces_of<10>(batch, law, x, forces);
}

void blend_stiffness(const TetBatch& batch, const material::ShapeBlend& law, const double* x, double* blocks) {
    batch.nodes_per_tet == 4 ? blend_stiffness_of<4>(batch, law, x, blocks)
                             : blend_stiffness_of<10>(batch, law, x, blocks);
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
