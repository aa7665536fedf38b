// Compiled once for each instruction set; the one that the machine has is chosen when the program runs.
//
// What stands at each point: see element_point-inl.hpp.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simulation/elements/element_kernels.cpp"
#include "simulation/elements/element_kernels.hpp"

#include <hwy/foreach_target.h>
// After foreach_target, as it asks.
#include <hwy/highway.h>

#include "simulation/elements/element_point-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pliant::sim::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// The exact stiffness of one point.
template <bool second>
struct TangentForm {
    Point<second> p;
    Factors<second> k;
    Matrix left{};  ///< F F^T

    struct OfNode {
        Vector g, f, h, e;  ///< a, F a, G a, E a
    };

    HWY_INLINE TangentForm(const Point<second>& point, const material::InvariantForm& law, V volume)
        : p(point), k(point, law, volume) {
        if constexpr (second) left = left_cauchy(point.F);
    }
    [[nodiscard]] HWY_INLINE OfNode of_node(const Vector& gradient) const {
        OfNode node{gradient, times(p.F, gradient), times(p.G, gradient), {}};
        if constexpr (second) node.e = times(p.E, gradient);
        return node;
    }
    HWY_INLINE void add_pair(const OfNode& a, const OfNode& b, V (*block)[3]) const {
        const V product = dot(a.g, b.g);
        V diagonal = hn::Mul(k.same, product);
        V ff = k.ff;
        if constexpr (second) {
            diagonal = hn::MulAdd(k.second_E, hn::MulSub(p.I1, product, dot(a.f, b.f)), diagonal);
            ff = hn::MulAdd(set(2), k.second_E, ff);
        }
        const V straight = hn::Add(k.hh, k.twist);
        for (int c = 0; c < 3; ++c) {
            const V of_f = hn::MulAdd(ff, b.f.v[c], hn::Mul(k.fh, b.h.v[c]));
            V of_h = hn::MulAdd(k.fh, b.f.v[c], hn::Mul(straight, b.h.v[c]));
            if constexpr (second) of_h = hn::MulAdd(k.eh, b.e.v[c], of_h);
            const V of_hb = hn::Mul(k.twist, a.h.v[c]);
            for (int r = 0; r < 3; ++r) {
                V entry = hn::MulAdd(a.f.v[r], of_f, hn::MulAdd(a.h.v[r], of_h, block[c][r]));
                entry = hn::NegMulAdd(b.h.v[r], of_hb, entry);
                if constexpr (second) {
                    entry = hn::MulAdd(a.e.v[r], hn::Mul(k.eh, b.h.v[c]), entry);
                    const V mixed = hn::MulAdd(b.f.v[r], a.f.v[c], hn::Mul(product, left.m[c][r]));
                    entry = hn::NegMulAdd(k.second_E, mixed, entry);
                }
                block[c][r] = r == c ? hn::Add(entry, diagonal) : entry;
            }
        }
    }
};

template <int nodes>
BatchResult forces_by_law(const TetBatch& batch, const material::InvariantForm& law, const double* x, double* result) {
    return law.c01_Pa != 0 ? forces_of<Point<true>, nodes>(batch, law, x, result)
                           : forces_of<Point<false>, nodes>(batch, law, x, result);
}

BatchResult forces(const TetBatch& batch, const material::InvariantForm& law, const double* x, double* result) {
    return batch.nodes_per_tet == 4 ? forces_by_law<4>(batch, law, x, result)
                                    : forces_by_law<10>(batch, law, x, result);
}

void tangent(const TetBatch& batch, const material::InvariantForm& law, const double* x, double* blocks) {
    stiffness<TangentForm>(batch, law, x, blocks);
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
