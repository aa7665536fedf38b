// Compiled once for each instruction set; the one that the machine has is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sim/turning_kernels.cpp"
#include <hwy/foreach_target.h>
// After foreach_target, as it asks.
#include <hwy/highway.h>

#include "sim/element_lanes-inl.hpp"

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

HWY_INLINE Matrix inverse(const Matrix& F) {
    const Matrix G = cofactor(F);
    const V J = hn::MulAdd(F.m[0][2], G.m[0][2], hn::MulAdd(F.m[0][1], G.m[0][1], hn::Mul(F.m[0][0], G.m[0][0])));
    const V scale = hn::Div(set(1), J);
    Matrix result;
    for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) result.m[j][i] = hn::Mul(scale, G.m[i][j]);
    }
    return result;
}

/// Polynomials of a matrix: by Cayley and Hamilton c[0] I + c[1] A + c[2] A^2 holds all of them, so that a series takes
/// sums of numbers and no product of matrices.
class Polynomials {
public:
    struct Coefficients {
        V c[3];
    };

    HWY_INLINE explicit Polynomials(const Matrix& A) : A_(A), square_(product(A, A)) {
        trace_ = trace(A);
        second_ = hn::Mul(set(0.5), hn::MulSub(trace_, trace_, trace(square_)));
        const Matrix G = cofactor(A);
        determinant_ =
            hn::MulAdd(A.m[0][2], G.m[0][2], hn::MulAdd(A.m[0][1], G.m[0][1], hn::Mul(A.m[0][0], G.m[0][0])));
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

/// Taylor's series of M / 8, squared three times: twelve digits up to a norm of 1, four up to 4.
HWY_INLINE Matrix exponential(const Matrix& M) {
    constexpr int squarings = 3;
    constexpr int terms = 7;
    const Polynomials of_A(combine(1.0 / (1 << squarings), M, 0, M));
    Polynomials::Coefficients sum{{set(1), set(1.0 / terms), hn::Zero(Tag())}};
    for (int k = terms - 1; k > 0; --k) sum = of_A.times_A_plus(sum, 1.0 / k, 1);
    for (int k = 0; k < squarings; ++k) sum = of_A.squared(sum);
    return of_A.of(sum);
}

/// -log(I - M) by its series, which is cut after M^6 / 6: what one step turned, of less than half a radian or so.
HWY_INLINE Matrix logarithm(const Matrix& M) {
    constexpr int terms = 6;
    const Polynomials of_M(M);
    Polynomials::Coefficients sum{{set(1.0 / (terms - 1)), set(1.0 / terms), hn::Zero(Tag())}};
    for (int k = terms - 2; k >= 0; --k) sum = of_M.times_A_plus(sum, 1, k > 0 ? 1.0 / k : 0);
    return of_M.of(sum);
}

template <int nodes>
void turn(const TetBatch& batch, const Turning& turning, double stiffness, double* forces) {
    const Tag d;
    constexpr int N = static_cast<int>(hn::MaxLanes(Tag()));
    for (int part = 0; part < batch_lanes; part += N) {
        V now[nodes][3], end[nodes][3], before[nodes][3], first[nodes][3];
        load_positions<nodes>(batch, turning.now, part, now);
        load_positions<nodes>(batch, turning.end, part, end);
        if (turning.before != nullptr) load_positions<nodes>(batch, turning.before, part, before);
        if (turning.first != nullptr) load_positions<nodes>(batch, turning.first, part, first);
        V sum[nodes][3];
        for (auto& row : sum) {
            for (V& entry : row) entry = hn::Zero(d);
        }
        for (int q = 0; q < batch.points; ++q) {
            const Matrix F = deformation_gradient<nodes>(batch, q, part, now);
            const Matrix E = deformation_gradient<nodes>(batch, q, part, end);
            const Matrix back = inverse(F);
            Matrix rate;
            if (turning.before == nullptr) {
                rate = product(combine(1, E, -1, F), back);
            } else {
                const Matrix B = deformation_gradient<nodes>(batch, q, part, before);
                rate = logarithm(combine(1, identity(1), -1, product(B, back)));
                Matrix earlier = rate;
                if (turning.first != nullptr) {
                    const Matrix A = deformation_gradient<nodes>(batch, q, part, first);
                    earlier = logarithm(combine(1, identity(1), -1, product(A, inverse(B))));
                }
                rate = combine(turning.onward, rate, turning.earlier, earlier);
            }
            const Matrix D = combine(1, product(exponential(rate), F), -1, E);
            const V weight = hn::Mul(set(stiffness), hn::Load(d, batch.volumes + q * batch_lanes + part));
            for (int a = 0; a < nodes; ++a) {
                const Vector f = times(D, gradient(batch, q, a, part));
                for (int k = 0; k < 3; ++k) sum[a][k] = hn::MulAdd(weight, f.v[k], sum[a][k]);
            }
        }
        for (int a = 0; a < nodes; ++a) {
            for (int k = 0; k < 3; ++k) hn::Store(sum[a][k], d, forces + (3 * a + k) * batch_lanes + part);
        }
    }
}

void turning_forces(const TetBatch& batch, const Turning& turning, double stiffness, double* forces) {
    if (batch.nodes_per_tet == 4)
        turn<4>(batch, turning, stiffness, forces);
    else
        turn<10>(batch, turning, stiffness, forces);
}

}  // namespace pliant::sim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pliant::sim {

HWY_EXPORT(turning_forces);

void batch_turning(const TetBatch& batch, const Turning& turning, double stiffness, double* forces) {
    HWY_DYNAMIC_DISPATCH(turning_forces)(batch, turning, stiffness, forces);
}

}  // namespace pliant::sim
#endif
