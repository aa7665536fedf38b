// Solves with panels, for eight right-hand sides that are interleaved.
// Compiled once for each instruction set; the best one available is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/linalg/panel_lanes.cpp"
#include <hwy/foreach_target.h>

#include "base/linalg/panel.hpp"
// Must follow foreach_target.
#include <hwy/highway.h>

#include <algorithm>

#include "base/linalg/panel_reading.hpp"

HWY_BEFORE_NAMESPACE();
namespace pliant::linalg::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Eight rows of a panel against vectors of lanes.
template <class Real>
struct Lanes {
    using D = hn::CappedTag<Real, lanes>;
    using V = hn::Vec<D>;
    static constexpr int rows = 8;
    static constexpr int width = static_cast<int>(hn::MaxLanes(D()));

    static HWY_INLINE V load(const Real* x, int row, int part) { return hn::Load(D(), x + row * lanes + part); }
    static HWY_INLINE void store(V v, Real* x, int row, int part) { hn::Store(v, D(), x + row * lanes + part); }

    /// sums (rows) += or -= rows of the panel times x, over the first `depth` columns; `a` points to the first of them
    /// in column 0.
    template <bool subtract>
    static HWY_INLINE void multiply(const Real* a, int depth, const Real* x, int part, V* sums) {
        for (int k = 0; k < depth; ++k) {
            const V xk = load(x, k, part);
            for (int r = 0; r < rows; ++r) {
                const V entry = hn::Set(D(), a[k * packet<Real> + r]);
                sums[r] = subtract ? hn::NegMulAdd(entry, xk, sums[r]) : hn::MulAdd(entry, xk, sums[r]);
            }
        }
    }
    /// x (columns from `first` to `last`) -= transposed rows of the panel times y (rows).
    static HWY_INLINE void subtract_transposed(const Real* a, int first, int last, const V* y, Real* x, int part) {
        for (int k = first; k < last; ++k) {
            V even = load(x, k, part), odd = hn::Zero(D());
            for (int r = 0; r < rows; r += 2) {
                even = hn::NegMulAdd(hn::Set(D(), a[k * packet<Real> + r]), y[r], even);
                odd = hn::NegMulAdd(hn::Set(D(), a[k * packet<Real> + r + 1]), y[r + 1], odd);
            }
            store(hn::Add(even, odd), x, k, part);
        }
    }
};

template <class Real>
void solve_lower_lanes_of(const Panel<Real>& panel, Real* x, const LaneRows<Real>& below) {
    using L = Lanes<Real>;
    using V = typename L::V;
    constexpr int P = packet<Real>;
    for (int part = 0; part < lanes; part += L::width) {
        for (int first = 0; first < panel.columns; first += L::rows) {
            const int width = std::min(L::rows, panel.columns - first);
            const Real* a = panel.at(first, 0);
            V sums[L::rows];
            for (int r = 0; r < L::rows; ++r)
                sums[r] = r < width ? L::load(x, first + r, part) : hn::Zero(typename L::D());
            L::template multiply<true>(a, first, x, part, sums);
            for (int j = 0; j < width; ++j) {
                const Real* column = a + (first + j) * P;
                sums[j] = hn::Mul(sums[j], hn::Set(typename L::D(), 1 / column[j]));
                for (int r = j + 1; r < width; ++r)
                    sums[r] = hn::NegMulAdd(hn::Set(typename L::D(), column[r]), sums[j], sums[r]);
                L::store(sums[j], x, first + j, part);
            }
        }
    }
    const int start = panel.first_below();
    share_reading(0, whole_packets<Real>(panel.below) / L::rows, L::rows * panel.columns, [&](int begin, int end) {
        for (int part = 0; part < lanes; part += L::width) {
            for (int row = begin * L::rows; row < end * L::rows; row += L::rows) {
                V sums[L::rows];
                for (V& sum : sums) sum = hn::Zero(typename L::D());
                L::template multiply<false>(panel.at(start + row, 0), panel.columns, x, part, sums);
                const int count = std::min(L::rows, panel.below - row);
                for (int r = 0; r < count; ++r) {
                    Real* at = below.at(row + r);
                    L::store(hn::Sub(L::load(at, 0, part), sums[r]), at, 0, part);
                }
            }
        }
    });
}

template <class Real>
void solve_upper_lanes_of(const Panel<Real>& panel, Real* x, const LaneRows<Real>& given) {
    using L = Lanes<Real>;
    using V = typename L::V;
    constexpr int P = packet<Real>;
    const int start = panel.first_below(), below = whole_packets<Real>(panel.below);
    share_reading(0, panel.columns, below, [&](int begin, int end) {
        for (int part = 0; part < lanes; part += L::width) {
            for (int row = 0; row < below; row += L::rows) {
                V rows[L::rows];
                for (int r = 0; r < L::rows; ++r)
                    rows[r] = row + r < panel.below ? L::load(given.at(row + r), 0, part) : hn::Zero(typename L::D());
                L::subtract_transposed(panel.at(start + row, 0), begin, end, rows, x, part);
            }
        }
    });
    for (int part = 0; part < lanes; part += L::width) {
        for (int first = (panel.columns - 1) / L::rows * L::rows; first >= 0; first -= L::rows) {
            const int width = std::min(L::rows, panel.columns - first);
            const Real* a = panel.at(first, 0);
            V solved[L::rows];
            for (int r = 0; r < L::rows; ++r)
                solved[r] = r < width ? L::load(x, first + r, part) : hn::Zero(typename L::D());
            for (int j = width - 1; j >= 0; --j) {
                const Real* column = a + (first + j) * P;
                for (int r = j + 1; r < width; ++r)
                    solved[j] = hn::NegMulAdd(hn::Set(typename L::D(), column[r]), solved[r], solved[j]);
                solved[j] = hn::Mul(solved[j], hn::Set(typename L::D(), 1 / column[j]));
                L::store(solved[j], x, first + j, part);
            }
            L::subtract_transposed(a, 0, first, solved, x, part);
        }
    }
}

template <class Real>
void add_lane_products_of(int count, const Real* a, const Real* b, Real* sums) {
    using L = Lanes<Real>;
    using V = typename L::V;
    for (int part = 0; part < lanes; part += L::width) {
        V rows[lanes];
        for (int i = 0; i < lanes; ++i) rows[i] = L::load(sums, i, part);
        for (int u = 0; u < count; ++u) {
            const V right = L::load(b, u, part);
            for (int i = 0; i < lanes; ++i)
                rows[i] = hn::MulAdd(hn::Set(typename L::D(), a[u * lanes + i]), right, rows[i]);
        }
        for (int i = 0; i < lanes; ++i) L::store(rows[i], sums, i, part);
    }
}

// Non-template names for the dispatch table below.
void lane_products_double(int count, const double* a, const double* b, double* sums) {
    add_lane_products_of(count, a, b, sums);
}
void lane_products_float(int count, const float* a, const float* b, float* sums) {
    add_lane_products_of(count, a, b, sums);
}
void lower_lanes_double(const Panel<double>& p, double* x, const LaneRows<double>& rows) {
    solve_lower_lanes_of(p, x, rows);
}
void lower_lanes_float(const Panel<float>& p, float* x, const LaneRows<float>& rows) {
    solve_lower_lanes_of(p, x, rows);
}
void upper_lanes_double(const Panel<double>& p, double* x, const LaneRows<double>& rows) {
    solve_upper_lanes_of(p, x, rows);
}
void upper_lanes_float(const Panel<float>& p, float* x, const LaneRows<float>& rows) {
    solve_upper_lanes_of(p, x, rows);
}

}  // namespace pliant::linalg::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pliant::linalg {

HWY_EXPORT(lane_products_double);
HWY_EXPORT(lane_products_float);
HWY_EXPORT(lower_lanes_double);
HWY_EXPORT(lower_lanes_float);
HWY_EXPORT(upper_lanes_double);
HWY_EXPORT(upper_lanes_float);

template <>
void solve_lower_lanes(const Panel<double>& panel, double* x, const LaneRows<double>& rows) {
    HWY_DYNAMIC_DISPATCH(lower_lanes_double)(panel, x, rows);
}
template <>
void solve_lower_lanes(const Panel<float>& panel, float* x, const LaneRows<float>& rows) {
    HWY_DYNAMIC_DISPATCH(lower_lanes_float)(panel, x, rows);
}
template <>
void solve_upper_lanes(const Panel<double>& panel, double* x, const LaneRows<double>& rows) {
    HWY_DYNAMIC_DISPATCH(upper_lanes_double)(panel, x, rows);
}
template <>
void solve_upper_lanes(const Panel<float>& panel, float* x, const LaneRows<float>& rows) {
    HWY_DYNAMIC_DISPATCH(upper_lanes_float)(panel, x, rows);
}
template <>
void add_lane_products(int count, const double* a, const double* b, double* sums) {
    HWY_DYNAMIC_DISPATCH(lane_products_double)(count, a, b, sums);
}
template <>
void add_lane_products(int count, const float* a, const float* b, float* sums) {
    HWY_DYNAMIC_DISPATCH(lane_products_float)(count, a, b, sums);
}

}  // namespace pliant::linalg
#endif
