// Matrices of several tets at once, and loading them: shared by the kernels. Included once for each instruction set, by
// files that hwy/foreach_target.h compiles; hence no ordinary include guard.
#if defined(PLIANT_SIM_ELEMENT_LANES_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef PLIANT_SIM_ELEMENT_LANES_INL_HPP
#undef PLIANT_SIM_ELEMENT_LANES_INL_HPP
#else
#define PLIANT_SIM_ELEMENT_LANES_INL_HPP
#endif

#include <hwy/highway.h>

#include "simulation/elements/element_kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace pliant::sim::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<double, batch_lanes>;
using V = hn::Vec<Tag>;

HWY_INLINE V set(double value) {
    return hn::Set(Tag(), value);
}

struct Vector {
    V v[3];
};
/// By columns.
struct Matrix {
    V m[3][3];
};

HWY_INLINE V dot(const Vector& a, const Vector& b) {
    return hn::MulAdd(a.v[2], b.v[2], hn::MulAdd(a.v[1], b.v[1], hn::Mul(a.v[0], b.v[0])));
}

HWY_INLINE Vector times(const Matrix& A, const Vector& x) {
    Vector y;
    for (int i = 0; i < 3; ++i)
        y.v[i] = hn::MulAdd(A.m[2][i], x.v[2], hn::MulAdd(A.m[1][i], x.v[1], hn::Mul(A.m[0][i], x.v[0])));
    return y;
}

HWY_INLINE Vector gradient(const TetBatch& batch, int point, int node, int part) {
    Vector g;
    const double* at = batch.gradients + ((point * batch.nodes_per_tet + node) * 3) * batch_lanes + part;
    for (int k = 0; k < 3; ++k) g.v[k] = hn::Load(Tag(), at + k * batch_lanes);
    return g;
}

/// Positions of the tets' nodes, (nodes, 3).
template <int nodes>
HWY_INLINE void load_positions(const TetBatch& batch, const double* x, int part, V (*positions)[3]) {
    const hn::RebindToSigned<Tag> d64;
    const hn::Rebind<int, Tag> d32;
    for (int a = 0; a < nodes; ++a) {
        const auto node = hn::PromoteTo(d64, hn::Load(d32, batch.nodes + a * batch_lanes + part));
        const auto index = hn::Add(hn::Add(node, node), node);
        for (int k = 0; k < 3; ++k) positions[a][k] = hn::GatherIndex(Tag(), x + k, index);
    }
}

template <int nodes>
HWY_INLINE Matrix deformation_gradient(const TetBatch& batch, int point, int part, const V (*positions)[3]) {
    Matrix F;
    for (auto& column : F.m) {
        for (V& entry : column) entry = hn::Zero(Tag());
    }
    for (int a = 0; a < nodes; ++a) {
        const Vector g = gradient(batch, point, a, part);
        for (int j = 0; j < 3; ++j) {
            for (int i = 0; i < 3; ++i) F.m[j][i] = hn::MulAdd(positions[a][i], g.v[j], F.m[j][i]);
        }
    }
    return F;
}

HWY_INLINE Matrix cofactor(const Matrix& F) {
    Matrix G;
    for (int j = 0; j < 3; ++j) {
        const auto& p = F.m[(j + 1) % 3];
        const auto& q = F.m[(j + 2) % 3];
        for (int i = 0; i < 3; ++i) {
            const int k = (i + 1) % 3;
            const int l = (i + 2) % 3;
            G.m[j][i] = hn::MulSub(p[k], q[l], hn::Mul(p[l], q[k]));
        }
    }
    return G;
}

/// Determinant of F, given its cofactors G.
HWY_INLINE V determinant_by(const Matrix& F, const Matrix& G) {
    return hn::MulAdd(F.m[0][2], G.m[0][2], hn::MulAdd(F.m[0][1], G.m[0][1], hn::Mul(F.m[0][0], G.m[0][0])));
}

/// F^T F, or F F^T with the loop transposed: entries (i, j).
HWY_INLINE Matrix right_cauchy(const Matrix& F) {
    Matrix C;
    for (int j = 0; j < 3; ++j) {
        for (int i = 0; i <= j; ++i) {
            C.m[j][i] = C.m[i][j] =
                hn::MulAdd(F.m[i][2], F.m[j][2], hn::MulAdd(F.m[i][1], F.m[j][1], hn::Mul(F.m[i][0], F.m[j][0])));
        }
    }
    return C;
}

HWY_INLINE Matrix left_cauchy(const Matrix& F) {
    Matrix B;
    for (int j = 0; j < 3; ++j) {
        for (int i = 0; i <= j; ++i) {
            B.m[j][i] = B.m[i][j] =
                hn::MulAdd(F.m[2][i], F.m[2][j], hn::MulAdd(F.m[1][i], F.m[1][j], hn::Mul(F.m[0][i], F.m[0][j])));
        }
    }
    return B;
}

}  // namespace pliant::sim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
