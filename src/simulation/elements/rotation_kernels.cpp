// Compiled once for each instruction set; the one that the machine has is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simulation/elements/rotation_kernels.cpp"
#include <hwy/foreach_target.h>
// After foreach_target, as it asks.
#include <hwy/highway.h>

#include "simulation/elements/element_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pliant::sim::HWY_NAMESPACE {

HWY_INLINE Matrix product(const Matrix& A, const Matrix& B) {
    Matrix C;
    for (int j = 0; j < 3; ++j) {
        const Vector column = times(A, {{B.m[j][0], B.m[j][1], B.m[j][2]}});
        for (int i = 0; i < 3; ++i) C.m[j][i] = column.v[i];
    }
    return C;
}

/// a A + b B.
HWY_INLINE Matrix combine(double a, const Matrix& A, double b, const Matrix& B) {
    Matrix C;
    for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) C.m[j][i] = hn::MulAdd(set(a), A.m[j][i], hn::Mul(set(b), B.m[j][i]));
    }
    return C;
}

HWY_INLINE Matrix identity(double scale) {
    Matrix I;
    for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) I.m[j][i] = set(i == j ? scale : 0);
    }
    return I;
}

/// Of F with the cofactors G.
HWY_INLINE V determinant(const Matrix& F, const Matrix& G) {
    return hn::MulAdd(F.m[0][2], G.m[0][2], hn::MulAdd(F.m[0][1], G.m[0][1], hn::Mul(F.m[0][0], G.m[0][0])));
}

HWY_INLINE Matrix inverse(const Matrix& F) {
    const Matrix G = cofactor(F);
    const V J = determinant(F, G);
    const V scale = hn::Div(set(1), J);
    Matrix result;
    for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) result.m[j][i] = hn::Mul(scale, G.m[i][j]);
    }
    return result;
}

/// Polynomials of a matrix: by the Cayley-Hamilton theorem c[0] I + c[1] A + c[2] A^2 represents all of them, so that
/// series need only scalar operations instead of matrix products.
class Polynomials {
public:
    struct Coefficients {
        V c[3];
    };

    HWY_INLINE explicit Polynomials(const Matrix& A) : A_(A), square_(product(A, A)) {
        trace_ = trace(A);
        second_ = hn::Mul(set(0.5), hn::MulSub(trace_, trace_, trace(square_)));
        determinant_ = determinant(A, cofactor(A));
    }
    /// scale p A + constant, by A^3 = trace A^2 - second A + determinant I.
    [[nodiscard]] HWY_INLINE Coefficients times_A_plus(const Coefficients& p, double scale, double constant) const {
        const V high = hn::Mul(set(scale), p.c[2]);
        return {{hn::MulAdd(high, determinant_, set(constant)), hn::MulSub(set(scale), p.c[0], hn::Mul(high, second_)),
                 hn::MulAdd(set(scale), p.c[1], hn::Mul(high, trace_))}};
    }
    [[nodiscard]] HWY_INLINE Coefficients squared(const Coefficients& p) const {
        const V fourth = hn::Mul(p.c[2], p.c[2]);
        const V third = hn::MulAdd(fourth, trace_, hn::Mul(hn::Add(p.c[1], p.c[1]), p.c[2]));
        const V twice = hn::Add(p.c[0], p.c[0]);
        V second = hn::MulAdd(p.c[1], p.c[1], hn::Mul(twice, p.c[2]));
        second = hn::MulAdd(third, trace_, hn::NegMulAdd(fourth, second_, second));
        V first = hn::MulAdd(fourth, determinant_, hn::Mul(twice, p.c[1]));
        first = hn::NegMulAdd(third, second_, first);
        return {{hn::MulAdd(third, determinant_, hn::Mul(p.c[0], p.c[0])), first, second}};
    }
    [[nodiscard]] HWY_INLINE Matrix of(const Coefficients& p) const {
        Matrix result;
        for (int j = 0; j < 3; ++j) {
            for (int i = 0; i < 3; ++i) {
                const V low = i == j ? p.c[0] : hn::Zero(Tag());
                result.m[j][i] = hn::MulAdd(p.c[2], square_.m[j][i], hn::MulAdd(p.c[1], A_.m[j][i], low));
            }
        }
        return result;
    }

private:
    static HWY_INLINE V trace(const Matrix& M) { return hn::Add(hn::Add(M.m[0][0], M.m[1][1]), M.m[2][2]); }
    Matrix A_, square_;
    V trace_, second_, determinant_;
};

/// Taylor series of M / 8, squared three times: twelve digits up to a norm of 1, four up to 4.
HWY_INLINE Matrix exponential(const Matrix& M) {
    constexpr int squarings = 3;
    constexpr int terms = 7;
    const Polynomials of_A(combine(1.0 / (1 << squarings), M, 0, M));
    Polynomials::Coefficients sum{{set(1), set(1.0 / terms), hn::Zero(Tag())}};
    for (int k = terms - 1; k > 0; --k) sum = of_A.times_A_plus(sum, 1.0 / k, 1);
    for (int k = 0; k < squarings; ++k) sum = of_A.squared(sum);
    return of_A.of(sum);
}

/// -log(I - M) by its series up to M^6 / 6: for the rotation of one step, of less than about half a radian.
HWY_INLINE Matrix logarithm(const Matrix& M) {
    constexpr int terms = 6;
    const Polynomials of_M(M);
    Polynomials::Coefficients sum{{set(1.0 / (terms - 1)), set(1.0 / terms), hn::Zero(Tag())}};
    for (int k = terms - 2; k >= 0; --k) sum = of_M.times_A_plus(sum, 1, k > 0 ? 1.0 / k : 0);
    return of_M.of(sum);
}

/// Positions of the nodes of several tets in the states of a RotatingStep.
template <int nodes>
struct States {
    V now[nodes][3], end[nodes][3], past[RotatingStep::most_past][nodes][3];
    std::size_t past_count = 0;

    HWY_INLINE States(const TetBatch& batch, const RotatingStep& rotating, int part) {
        load_positions<nodes>(batch, rotating.now, part, now);
        load_positions<nodes>(batch, rotating.end, part, end);
        for (; past_count < RotatingStep::most_past && rotating.past[past_count] != nullptr; ++past_count)
            load_positions<nodes>(batch, rotating.past[past_count], part, past[past_count]);
    }
};

/// M of a RotatingStep at one point; `F` and `E` are the deformation gradients now and at the end of the straight step.
template <int nodes>
HWY_INLINE Matrix rate_of(const TetBatch& batch, const RotatingStep& rotating, const States<nodes>& states, int point,
                          int part, const Matrix& F, const Matrix& E) {
    if (states.past_count == 0) return product(combine(1, E, -1, F), inverse(F));
    Matrix sum = identity(0);
    Matrix after = F;
    for (std::size_t k = 0; k < states.past_count; ++k) {
        const Matrix before = deformation_gradient<nodes>(batch, point, part, states.past[k]);
        const Matrix rate = logarithm(combine(1, identity(1), -1, product(before, inverse(after))));
        sum = combine(1, sum, rotating.weights[k], rate);
        after = before;
    }
    return sum;
}

/// Clears (nodes, 3).
template <int nodes>
HWY_INLINE void clear(V (*sums)[3]) {
    for (int a = 0; a < nodes; ++a) {
        for (int k = 0; k < 3; ++k) sums[a][k] = hn::Zero(Tag());
    }
}

/// Adds the forces of a stress that is integrated at one point: sums_a += weight P grad N_a.
template <int nodes>
HWY_INLINE void add_forces(const TetBatch& batch, int point, int part, const Matrix& P, V weight, V (*sums)[3]) {
    for (int a = 0; a < nodes; ++a) {
        const Vector f = times(P, gradient(batch, point, a, part));
        for (int k = 0; k < 3; ++k) sums[a][k] = hn::MulAdd(weight, f.v[k], sums[a][k]);
    }
}

HWY_INLINE V weight_of(const TetBatch& batch, int point, int part, double stiffness) {
    return hn::Mul(set(stiffness), hn::Load(Tag(), batch.volumes + point * batch_lanes + part));
}

template <int nodes>
HWY_INLINE void store(const V (*sums)[3], int part, double* forces) {
    for (int a = 0; a < nodes; ++a) {
        for (int k = 0; k < 3; ++k) hn::Store(sums[a][k], Tag(), forces + (3 * a + k) * batch_lanes + part);
    }
}

template <int nodes>
void rotation_term_of(const TetBatch& batch, const RotatingStep& rotating, double stiffness, double* forces) {
    constexpr int N = static_cast<int>(hn::MaxLanes(Tag()));
    for (int part = 0; part < batch_lanes; part += N) {
        const States<nodes> states(batch, rotating, part);
        V sums[nodes][3];
        clear<nodes>(sums);
        for (int q = 0; q < batch.points; ++q) {
            const Matrix F = deformation_gradient<nodes>(batch, q, part, states.now);
            const Matrix E = deformation_gradient<nodes>(batch, q, part, states.end);
            const Matrix rate = rate_of<nodes>(batch, rotating, states, q, part, F, E);
            const Matrix D = combine(1, product(exponential(rate), F), -1, E);
            add_forces<nodes>(batch, q, part, D, weight_of(batch, q, part, stiffness), sums);
        }
        store<nodes>(sums, part, forces);
    }
}

/// The rotation nearest to F, by Newton's iteration (Higham 1986): twelve digits for stretches from 1/2 to 2.
HWY_INLINE Matrix rotation_of(const Matrix& F) {
    constexpr int iterations = 5;
    Matrix R = F;
    for (int k = 0; k < iterations; ++k) {
        const Matrix G = cofactor(R);
        const V share = hn::Div(set(0.5), determinant(R, G));
        for (int j = 0; j < 3; ++j) {
            for (int i = 0; i < 3; ++i) R.m[j][i] = hn::MulAdd(share, G.m[j][i], hn::Mul(set(0.5), R.m[j][i]));
        }
    }
    return R;
}

template <int nodes>
void find_rotations(const TetBatch& batch, const double* before, const double* now, double* rotations) {
    constexpr int N = static_cast<int>(hn::MaxLanes(Tag()));
    for (int part = 0; part < batch_lanes; part += N) {
        V x[nodes][3], y[nodes][3];
        load_positions<nodes>(batch, before, part, x);
        load_positions<nodes>(batch, now, part, y);
        for (int q = 0; q < batch.points; ++q) {
            const Matrix F = deformation_gradient<nodes>(batch, q, part, x);
            const Matrix G = deformation_gradient<nodes>(batch, q, part, y);
            const Matrix R = rotation_of(product(G, inverse(F)));
            for (int j = 0; j < 3; ++j) {
                for (int i = 0; i < 3; ++i)
                    hn::Store(R.m[j][i], Tag(), rotations + ((9 * q + 3 * j + i) * batch_lanes) + part);
            }
        }
    }
}

/// R, or its transpose.
HWY_INLINE Matrix load_rotation(const double* rotations, int point, int part, bool back) {
    Matrix R;
    for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) {
            const int entry = back ? 3 * i + j : 3 * j + i;
            R.m[j][i] = hn::Load(Tag(), rotations + (9 * point + entry) * batch_lanes + part);
        }
    }
    return R;
}

template <int nodes>
void rotate_field(const TetBatch& batch, const double* rotations, bool back, const double* u, double stiffness,
                  double* forces) {
    constexpr int N = static_cast<int>(hn::MaxLanes(Tag()));
    for (int part = 0; part < batch_lanes; part += N) {
        V field[nodes][3];
        load_positions<nodes>(batch, u, part, field);
        V sums[nodes][3];
        clear<nodes>(sums);
        for (int q = 0; q < batch.points; ++q) {
            const Matrix G = deformation_gradient<nodes>(batch, q, part, field);
            const Matrix turned = product(load_rotation(rotations, q, part, back), G);
            add_forces<nodes>(batch, q, part, turned, weight_of(batch, q, part, stiffness), sums);
        }
        store<nodes>(sums, part, forces);
    }
}

void rotation_term(const TetBatch& batch, const RotatingStep& rotating, double stiffness, double* forces) {
    if (batch.nodes_per_tet == 4)
        rotation_term_of<4>(batch, rotating, stiffness, forces);
    else
        rotation_term_of<10>(batch, rotating, stiffness, forces);
}

void rotations(const TetBatch& batch, const double* before, const double* now, double* result) {
    if (batch.nodes_per_tet == 4)
        find_rotations<4>(batch, before, now, result);
    else
        find_rotations<10>(batch, before, now, result);
}

void rotated_forces(const TetBatch& batch, const double* rotations, bool back, const double* u, double stiffness,
                    double* forces) {
    if (batch.nodes_per_tet == 4)
        rotate_field<4>(batch, rotations, back, u, stiffness, forces);
    else
        rotate_field<10>(batch, rotations, back, u, stiffness, forces);
}

}  // namespace pliant::sim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pliant::sim {

HWY_EXPORT(rotation_term);
HWY_EXPORT(rotations);
HWY_EXPORT(rotated_forces);

void batch_rotation_term(const TetBatch& batch, const RotatingStep& rotating, double stiffness, double* forces) {
    HWY_DYNAMIC_DISPATCH(rotation_term)(batch, rotating, stiffness, forces);
}

void batch_rotations(const TetBatch& batch, const double* before, const double* now, double* result) {
    HWY_DYNAMIC_DISPATCH(rotations)(batch, before, now, result);
}

void batch_rotated(const TetBatch& batch, const double* rotations, bool back, const double* u, double stiffness,
                   double* forces) {
    HWY_DYNAMIC_DISPATCH(rotated_forces)(batch, rotations, back, u, stiffness, forces);
}

}  // namespace pliant::sim
#endif
