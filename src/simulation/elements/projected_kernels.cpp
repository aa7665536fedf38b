// Compiled once for each instruction set; the one that the machine has is chosen when the program runs.
//
// Positive stiffness. With F = U diag(l) V^T, in the frames of U and V, the derivative of P couples the
// three stretches with one another (A below) and each pair of shears ij, ji only with each other: their sum has the
// eigenvalue (P_i - P_j) / (l_i - l_j), their difference (P_i + P_j) / (l_i + l_j), with P_i the derivative of the
// energy with respect to l_i. (Smith, de Goes and Kim 2019, "Analytic eigensystems for isotropic distortion energies".)
// Negative ones become small positive ones, linalg::weak_share of their size: with zeros a nearly incompressible body
// has directions without stiffness, along which a step goes too far by many orders of magnitude.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simulation/elements/projected_kernels.cpp"
#include <hwy/foreach_target.h>
// After foreach_target, as it asks.
#include <hwy/highway.h>

#include "base/linalg/small.hpp"
#include "simulation/elements/element_point-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pliant::sim::HWY_NAMESPACE {

HWY_INLINE V positive(V value) {
    return hn::Max(value, hn::Mul(set(-linalg::weak_share), value));
}

/// Eigendecomposition of a symmetric matrix: S = vectors diag(values) vectors^T, values unordered.
struct Eigen3 {
    V values[3];
    Matrix vectors;  ///< one per column
};

/// Jacobi rotations. After four sweeps the off-diagonal entries vanish in double precision.
HWY_INLINE Eigen3 eigen(Matrix S) {
    constexpr int sweeps = 4;
    Eigen3 result;
    for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) result.vectors.m[j][i] = set(i == j ? 1 : 0);
    }
    for (int k = 0; k < 3 * sweeps; ++k) {
        const int p = k % 3 == 2 ? 1 : 0;
        const int q = k % 3 == 0 ? 1 : 2;
        const int r = 3 - p - q;
        const V twice = hn::Add(S.m[q][p], S.m[q][p]);
        const V apart = hn::Sub(S.m[q][q], S.m[p][p]);
        const V root = hn::Sqrt(hn::MulAdd(apart, apart, hn::Mul(twice, twice)));
        // Tangent of the angle that zeroes S_pq; the smallest number in the denominator keeps it 0 if S_pq is 0.
        const V tangent =
            hn::Div(hn::CopySign(twice, hn::Mul(twice, apart)), hn::Add(hn::Add(hn::Abs(apart), root), set(1e-300)));
        const V cosine = hn::Div(set(1), hn::Sqrt(hn::MulAdd(tangent, tangent, set(1))));
        const V sine = hn::Mul(tangent, cosine);
        const V moved = hn::Mul(tangent, S.m[q][p]);
        S.m[p][p] = hn::Sub(S.m[p][p], moved);
        S.m[q][q] = hn::Add(S.m[q][q], moved);
        S.m[p][q] = S.m[q][p] = hn::Zero(Tag());
        const V with_p = S.m[r][p];
        const V with_q = S.m[r][q];
        S.m[r][p] = S.m[p][r] = hn::NegMulAdd(sine, with_q, hn::Mul(cosine, with_p));
        S.m[r][q] = S.m[q][r] = hn::MulAdd(sine, with_p, hn::Mul(cosine, with_q));
        for (int i = 0; i < 3; ++i) {
            const V at_p = result.vectors.m[p][i];
            const V at_q = result.vectors.m[q][i];
            result.vectors.m[p][i] = hn::NegMulAdd(sine, at_q, hn::Mul(cosine, at_p));
            result.vectors.m[q][i] = hn::MulAdd(sine, at_p, hn::Mul(cosine, at_q));
        }
    }
    for (int i = 0; i < 3; ++i) result.values[i] = S.m[i][i];
    return result;
}

/// The symmetric matrix with positive eigenvalues.
HWY_INLINE Matrix with_positive_eigenvalues(const Matrix& S) {
    const Eigen3 e = eigen(S);
    Matrix result;
    for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) {
            V sum = hn::Zero(Tag());
            for (int k = 0; k < 3; ++k)
                sum = hn::MulAdd(hn::Mul(positive(e.values[k]), e.vectors.m[k][i]), e.vectors.m[k][j], sum);
            result.m[j][i] = sum;
        }
    }
    return result;
}

/// The stiffness of one point in the frames of U and V, times its volume.
template <bool second>
struct PrincipalForm {
    Matrix U, right;       ///< right: V
    Matrix A;              ///< between stretches
    V same[3], across[3];  ///< of the shears about each axis: coupling of ij with itself, and with ji

    using OfNode = Vector;  ///< V^T a

    HWY_INLINE PrincipalForm(const Point<second>& p, const material::InvariantForm& law, V volume) {
        const Eigen3 e = eigen(right_cauchy(p.F));
        right = e.vectors;
        V l[3];
        for (int i = 0; i < 3; ++i) {
            l[i] = hn::Sqrt(hn::Max(e.values[i], set(1e-30)));
            const Vector column = times(p.F, {{right.m[i][0], right.m[i][1], right.m[i][2]}});
            for (int r = 0; r < 3; ++r) U.m[i][r] = hn::Div(column.v[r], l[i]);
        }
        const Factors<second> k(p, law, volume);
        const V along_G = hn::Mul(k.twist, p.J);
        set_stretches(p, k, along_G, l);
        for (int axis = 0; axis < 3; ++axis) {
            const V product = hn::Mul(l[(axis + 1) % 3], l[(axis + 2) % 3]);
            V together = hn::NegMulAdd(along_G, l[axis], k.same);
            V against = hn::MulAdd(along_G, l[axis], k.same);
            if constexpr (second) {
                const V square = hn::Mul(l[axis], l[axis]);
                together = hn::MulAdd(k.second_E, hn::Sub(square, product), together);
                against = hn::MulAdd(k.second_E, hn::Add(square, product), against);
            }
            together = positive(together);
            against = positive(against);
            same[axis] = hn::Mul(set(0.5), hn::Add(together, against));
            across[axis] = hn::Mul(set(0.5), hn::Sub(together, against));
        }
    }

    [[nodiscard]] HWY_INLINE OfNode of_node(const Vector& gradient) const {
        Vector result;
        for (int i = 0; i < 3; ++i) result.v[i] = dot(gradient, {{right.m[i][0], right.m[i][1], right.m[i][2]}});
        return result;
    }
    HWY_INLINE void add_pair(const OfNode& a, const OfNode& b, V (*block)[3]) const {
        Matrix K;
        for (int i = 0; i < 3; ++i) {
            const int j = (i + 1) % 3;
            const int k = (i + 2) % 3;
            K.m[i][i] = hn::Mul(A.m[i][i], hn::Mul(a.v[i], b.v[i]));
            K.m[i][i] = hn::MulAdd(same[k], hn::Mul(a.v[j], b.v[j]), K.m[i][i]);
            K.m[i][i] = hn::MulAdd(same[j], hn::Mul(a.v[k], b.v[k]), K.m[i][i]);
            // Rows belong to a. The shear of two directions is indexed by the third axis.
            K.m[j][i] = hn::MulAdd(A.m[j][i], hn::Mul(a.v[i], b.v[j]), hn::Mul(across[k], hn::Mul(a.v[j], b.v[i])));
            K.m[i][j] = hn::MulAdd(A.m[i][j], hn::Mul(a.v[j], b.v[i]), hn::Mul(across[k], hn::Mul(a.v[i], b.v[j])));
        }
        // U K U^T
        Matrix half;
        for (int j = 0; j < 3; ++j) {
            const Vector column = times(U, {{K.m[j][0], K.m[j][1], K.m[j][2]}});
            for (int i = 0; i < 3; ++i) half.m[j][i] = column.v[i];
        }
        for (int c = 0; c < 3; ++c) {
            for (int r = 0; r < 3; ++r) {
                for (int k = 0; k < 3; ++k) block[c][r] = hn::MulAdd(half.m[k][r], U.m[k][c], block[c][r]);
            }
        }
    }

private:
    HWY_INLINE void set_stretches(const Point<second>& p, const Factors<second>& k, V along_G, const V* l) {
        V h[3], e[3];  // dJ / dl, dI2 / dl
        for (int i = 0; i < 3; ++i) {
            h[i] = hn::Mul(l[(i + 1) % 3], l[(i + 2) % 3]);
            if constexpr (second) e[i] = hn::Mul(hn::Add(l[i], l[i]), hn::NegMulAdd(l[i], l[i], p.I1));
        }
        for (int j = 0; j < 3; ++j) {
            for (int i = 0; i <= j; ++i) {
                V entry = hn::MulAdd(k.ff, hn::Mul(l[i], l[j]), hn::Mul(k.hh, hn::Mul(h[i], h[j])));
                entry = hn::MulAdd(k.fh, hn::MulAdd(l[i], h[j], hn::Mul(h[i], l[j])), entry);
                entry = i == j ? hn::Add(entry, k.same) : hn::MulAdd(along_G, l[3 - i - j], entry);
                if constexpr (second) {
                    entry = hn::MulAdd(k.eh, hn::MulAdd(e[i], h[j], hn::Mul(h[i], e[j])), entry);
                    const V bend = i == j ? hn::NegMulAdd(l[i], l[i], p.I1) : hn::Mul(set(2), hn::Mul(l[i], l[j]));
                    entry = hn::MulAdd(k.second_E, bend, entry);
                }
                A.m[j][i] = A.m[i][j] = entry;
            }
        }
        A = with_positive_eigenvalues(A);
    }
};

void projected(const TetBatch& batch, const material::InvariantForm& law, const double* x, double* blocks) {
    stiffness<PrincipalForm>(batch, law, x, blocks);
}

}  // namespace pliant::sim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pliant::sim {

HWY_EXPORT(projected);

void batch_projected_tangent(const TetBatch& batch, const material::InvariantForm& law, const double* x,
                             double* blocks) {
    HWY_DYNAMIC_DISPATCH(projected)(batch, law, x, blocks);
}

}  // namespace pliant::sim
#endif
