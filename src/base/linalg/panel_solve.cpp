// Solves with panels, for up to four right-hand sides.
// Compiled once for each instruction set; the best one available is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/linalg/panel_solve.cpp"
#include <hwy/foreach_target.h>

#include "base/linalg/panel.hpp"
// Must follow foreach_target.
#include <hwy/highway.h>

#include <algorithm>
#include <type_traits>

#include "base/linalg/panel_reading.hpp"

HWY_BEFORE_NAMESPACE();
namespace pliant::linalg::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// y (packets of rows from `begin` to `end`, count vectors) = L x over the first `depth` columns; passed to `use`.
template <int count, class Real, class Use>
HWY_INLINE void multiply_packets(const Panel<Real>& panel, int depth, const Real* x, std::size_t x_stride, int begin,
                                 int end, const Use& use) {
    const hn::CappedTag<Real, packet<Real>> d;
    using V = hn::Vec<decltype(d)>;
    constexpr int P = packet<Real>;
    constexpr int N = static_cast<int>(hn::MaxLanes(d));
    constexpr int together = 4;  // independent sums, to hide the latency of additions
    const std::size_t stride = static_cast<std::size_t>(panel.columns) * P;
    const auto run = [&](auto chains, int p, int part) {
        constexpr int many = decltype(chains)::value;
        V sum[many][count];
        for (auto& row : sum) {
            for (V& s : row) s = hn::Zero(d);
        }
        const Real* a = panel.values + static_cast<std::size_t>(p) * stride + part;
        for (int k = 0; k < depth; ++k) {
            for (int c = 0; c < count; ++c) {
                const V xk = hn::Set(d, x[static_cast<std::size_t>(c) * x_stride + k]);
                for (int q = 0; q < many; ++q)
                    sum[q][c] = hn::MulAdd(hn::Load(d, a + q * stride + k * P), xk, sum[q][c]);
            }
        }
        for (int q = 0; q < many; ++q) {
            for (int c = 0; c < count; ++c) use(d, (p + q) * P + part, c, sum[q][c]);
        }
    };
    for (int part = 0; part < P; part += N) {
        int p = begin;
        for (; p + together <= end; p += together) run(std::integral_constant<int, together>{}, p, part);
        for (; p < end; ++p) run(std::integral_constant<int, 1>{}, p, part);
    }
}

template <int count, class Real>
void solve_lower_of(const Panel<Real>& panel, Real* x, Real* y) {
    constexpr int P = packet<Real>;
    const auto n = static_cast<std::size_t>(panel.columns);
    for (int first = 0; first < panel.columns; first += P) {
        const int last = std::min(first + P, panel.columns);
        HWY_ALIGN Real before[count][P];
        multiply_packets<count>(panel, first, x, n, first / P, first / P + 1,
                                [&](auto d, int r, int c, auto sum) { hn::Store(sum, d, before[c] + (r - first)); });
        for (int c = 0; c < count; ++c) {
            Real* xc = x + static_cast<std::size_t>(c) * n;
            for (int j = first; j < last; ++j) {
                Real value = xc[j] - before[c][j - first];
                for (int i = first; i < j; ++i) value -= *panel.at(j, i) * xc[i];
                xc[j] = value / *panel.at(j, j);
            }
        }
    }
    const int begin = panel.first_below() / P;
    const auto below = static_cast<std::size_t>(whole_packets<Real>(panel.below));
    share_reading(begin, panel.rows() / P, P * panel.columns, [&](int from, int to) {
        multiply_packets<count>(panel, panel.columns, x, n, from, to, [&](auto d, int r, int c, auto sum) {
            hn::StoreU(sum, d, y + static_cast<std::size_t>(c) * below + static_cast<std::size_t>(r - begin * P));
        });
    });
}

/// x (columns from `first` to `last`) -= L^T y over the packets begin .. end; y belongs to packet `begin` on.
template <int count, class Real>
HWY_INLINE void subtract_transposed(const Panel<Real>& panel, int first, int last, const Real* y, std::size_t y_stride,
                                    int begin, int end, Real* x) {
    const hn::CappedTag<Real, packet<Real>> d;
    using V = hn::Vec<decltype(d)>;
    constexpr int P = packet<Real>;
    constexpr int N = static_cast<int>(hn::MaxLanes(d));
    constexpr int together = 4;  // columns at a time
    const std::size_t stride = static_cast<std::size_t>(panel.columns) * P;
    const auto run = [&](auto chains, int k) {
        constexpr int many = decltype(chains)::value;
        V sum[many][count];
        for (auto& row : sum) {
            for (V& s : row) s = hn::Zero(d);
        }
        const Real* a = panel.values + static_cast<std::size_t>(begin) * stride + static_cast<std::size_t>(k) * P;
        for (int p = begin; p < end; ++p, a += stride) {
            for (int part = 0; part < P; part += N) {
                for (int c = 0; c < count; ++c) {
                    const V yp = hn::LoadU(d, y + static_cast<std::size_t>(c) * y_stride + (p - begin) * P + part);
                    for (int q = 0; q < many; ++q) sum[q][c] = hn::MulAdd(hn::Load(d, a + q * P + part), yp, sum[q][c]);
                }
            }
        }
        for (int q = 0; q < many; ++q) {
            for (int c = 0; c < count; ++c)
                x[static_cast<std::size_t>(c) * panel.columns + k + q] -= hn::GetLane(hn::SumOfLanes(d, sum[q][c]));
        }
    };
    int k = first;
    for (; k + together <= last; k += together) run(std::integral_constant<int, together>{}, k);
    for (; k < last; ++k) run(std::integral_constant<int, 1>{}, k);
}

template <int count, class Real>
void solve_upper_of(const Panel<Real>& panel, Real* x, const Real* y) {
    constexpr int P = packet<Real>;
    const auto n = static_cast<std::size_t>(panel.columns);
    const auto below = static_cast<std::size_t>(whole_packets<Real>(panel.below));
    const int begin = panel.first_below() / P, end = panel.rows() / P;
    share_reading(0, panel.columns, P * (end - begin),
                  [&](int from, int to) { subtract_transposed<count>(panel, from, to, y, below, begin, end, x); });
    for (int first = (panel.columns - 1) / P * P; first >= 0; first -= P) {
        const int last = std::min(first + P, panel.columns);
        HWY_ALIGN Real solved[count][P] = {};
        for (int c = 0; c < count; ++c) {
            Real* xc = x + static_cast<std::size_t>(c) * n;
            for (int j = last - 1; j >= first; --j) {
                Real value = xc[j];
                for (int i = j + 1; i < last; ++i) value -= *panel.at(i, j) * xc[i];
                xc[j] = solved[c][j - first] = value / *panel.at(j, j);
            }
        }
        subtract_transposed<count>(panel, 0, first, solved[0], static_cast<std::size_t>(P), first / P, first / P + 1,
                                   x);
    }
}

template <class Real>
void solve_lower_any(const Panel<Real>& panel, int count, Real* x, Real* y) {
    switch (count) {
        case 1:
            return solve_lower_of<1>(panel, x, y);
        case 2:
            return solve_lower_of<2>(panel, x, y);
        case 3:
            return solve_lower_of<3>(panel, x, y);
        default:
            return solve_lower_of<4>(panel, x, y);
    }
}

template <class Real>
void solve_upper_any(const Panel<Real>& panel, int count, Real* x, const Real* y) {
    switch (count) {
        case 1:
            return solve_upper_of<1>(panel, x, y);
        case 2:
            return solve_upper_of<2>(panel, x, y);
        case 3:
            return solve_upper_of<3>(panel, x, y);
        default:
            return solve_upper_of<4>(panel, x, y);
    }
}

// Non-template names for the dispatch table below.
void lower_double(const Panel<double>& p, int n, double* x, double* y) {
    solve_lower_any(p, n, x, y);
}
void lower_float(const Panel<float>& p, int n, float* x, float* y) {
    solve_lower_any(p, n, x, y);
}
void upper_double(const Panel<double>& p, int n, double* x, const double* y) {
    solve_upper_any(p, n, x, y);
}
void upper_float(const Panel<float>& p, int n, float* x, const float* y) {
    solve_upper_any(p, n, x, y);
}

}  // namespace pliant::linalg::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pliant::linalg {

HWY_EXPORT(lower_double);
HWY_EXPORT(lower_float);
HWY_EXPORT(upper_double);
HWY_EXPORT(upper_float);

template <>
void solve_lower(const Panel<double>& panel, int count, double* x, double* y) {
    HWY_DYNAMIC_DISPATCH(lower_double)(panel, count, x, y);
}
template <>
void solve_lower(const Panel<float>& panel, int count, float* x, float* y) {
    HWY_DYNAMIC_DISPATCH(lower_float)(panel, count, x, y);
}
template <>
void solve_upper(const Panel<double>& panel, int count, double* x, const double* y) {
    HWY_DYNAMIC_DISPATCH(upper_double)(panel, count, x, y);
}
template <>
void solve_upper(const Panel<float>& panel, int count, float* x, const float* y) {
    HWY_DYNAMIC_DISPATCH(upper_float)(panel, count, x, y);
}

}  // namespace pliant::linalg
#endif
