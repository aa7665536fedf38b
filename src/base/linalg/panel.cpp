// Factorises panels and makes their updates.
// Compiled once for each instruction set; the best one available is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/linalg/panel.cpp"
#include "base/linalg/panel.hpp"

#include <hwy/foreach_target.h>
// Must follow foreach_target.
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/core/parallel.hpp"

HWY_BEFORE_NAMESPACE();
namespace pliant::linalg::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Number of columns factorised together: the columns to their left are subtracted in one go.
constexpr int slab = 16;
/// Size of tiles kept in registers: this many packets by this many columns.
constexpr int tile_packets = HWY_TARGET <= HWY_AVX3 ? 2 : 1;
constexpr int tile_columns = HWY_TARGET <= HWY_AVX3 ? 8 : 4;
/// Products are split at this depth, so that their operands stay in the cache.
constexpr int product_depth = 256;
/// Minimum work for using another core, in multiply-adds.
constexpr double work_to_share = 3e5;

enum class To { store, subtract };

/// c (packets, columns) -= (or = -) sum over k < depth of a (packets, k) b (columns, k)^T. Packets of a are `a_stride`
/// apart, those of c `c_packet`, its columns `c_column`. Only `columns` <= tile_columns are written.
template <int packets, To to, class Real>
HWY_INLINE void subtract_tile(const Real* a, std::size_t a_stride, const Real* b, int depth, Real* c,
                              std::size_t c_packet, std::size_t c_column, int columns) {
    const hn::CappedTag<Real, packet<Real>> d;
    using V = hn::Vec<decltype(d)>;
    constexpr int P = packet<Real>;
    constexpr int N = static_cast<int>(hn::MaxLanes(d));
    constexpr int vectors = packets * P / N;
    V sum[vectors][tile_columns];
    for (auto& row : sum) {
        for (V& s : row) s = hn::Zero(d);
    }
    for (int k = 0; k < depth; ++k) {
        V av[vectors];
        for (int v = 0; v < vectors; ++v) av[v] = hn::Load(d, a + (v * N / P) * a_stride + k * P + v * N % P);
        for (int j = 0; j < tile_columns; ++j) {
            const V bj = hn::Set(d, b[k * P + j]);
            for (int v = 0; v < vectors; ++v) sum[v][j] = hn::MulAdd(av[v], bj, sum[v][j]);
        }
    }
    for (int j = 0; j < tile_columns; ++j) {
        if (j >= columns) return;
        for (int v = 0; v < vectors; ++v) {
            Real* entry = c + (v * N / P) * c_packet + j * c_column + v * N % P;
            const V before = to == To::store ? hn::Zero(d) : hn::Load(d, entry);
            hn::Store(hn::Sub(before, sum[v][j]), d, entry);
        }
    }
}

/// The tiles of `columns` columns and all packets from `begin` to `end`.
template <To to, class Real>
HWY_INLINE void subtract_strip(const Real* a, std::size_t a_stride, const Real* b, int depth, Real* c,
                               std::size_t c_packet, std::size_t c_column, int columns, int begin, int end) {
    int p = begin;
    for (; p + tile_packets <= end; p += tile_packets)
        subtract_tile<tile_packets, to>(a + p * a_stride, a_stride, b, depth, c + p * c_packet, c_packet, c_column,
                                        columns);
    for (; p < end; ++p)
        subtract_tile<1, to>(a + p * a_stride, a_stride, b, depth, c + p * c_packet, c_packet, c_column, columns);
}

/// Subtracts the contributions of earlier columns from columns first .. first + width of the packets begin .. end.
template <class Real>
void subtract_left(const Panel<Real>& panel, int first, int width, int begin, int end) {
    constexpr int P = packet<Real>;
    const std::size_t stride = static_cast<std::size_t>(panel.columns) * P;
    for (int j = 0; j < width; j += tile_columns) {
        const int row = first + j;
        const Real* b = panel.values + static_cast<std::size_t>(row / P) * stride + row % P;
        subtract_strip<To::subtract>(panel.values, stride, b, first, panel.at(0, row), stride,
                                     static_cast<std::size_t>(P), std::min(tile_columns, width - j), begin, end);
    }
}

/// Cholesky factor of the diagonal block at `first`; its inverse diagonal goes to `inverse`.
template <class Real>
bool factorise_block(const Panel<Real>& panel, int first, int width, Real (*L)[slab], Real* inverse) {
    for (int r = 0; r < width; ++r) {
        for (int c = 0; c <= r; ++c) L[c][r] = *panel.at(first + r, first + c);
    }
    for (int j = 0; j < width; ++j) {
        if (!(L[j][j] > 0) || !std::isfinite(L[j][j])) return false;
        const Real root = std::sqrt(L[j][j]);
        L[j][j] = root;
        inverse[j] = 1 / root;
        for (int r = j + 1; r < width; ++r) L[j][r] *= inverse[j];
        for (int c = j + 1; c < width; ++c) {
            for (int r = c; r < width; ++r) L[c][r] -= L[j][r] * L[j][c];
        }
    }
    for (int r = 0; r < width; ++r) {
        for (int c = 0; c < width; ++c) *panel.at(first + r, first + c) = c <= r ? L[c][r] : 0;
    }
    return true;
}

/// The packets begin .. end of these columns times L^-T.
template <int whole, class Real>
void divide_packets(const Panel<Real>& panel, int first, int width, const Real (*L)[slab], const Real* inverse,
                    int begin, int end) {
    const hn::CappedTag<Real, packet<Real>> d;
    using V = hn::Vec<decltype(d)>;
    constexpr int P = packet<Real>;
    constexpr int N = static_cast<int>(hn::MaxLanes(d));
    const int n = whole > 0 ? whole : width;
    for (int p = begin; p < end; ++p) {
        for (int part = 0; part < P; part += N) {
            Real* x = panel.at(p * P, first) + part;
            V column[slab];
            for (int j = 0; j < n; ++j) column[j] = hn::Load(d, x + j * P);
            for (int i = 0; i < n; ++i) {
                column[i] = hn::Mul(column[i], hn::Set(d, inverse[i]));
                for (int j = i + 1; j < n; ++j) column[j] = hn::NegMulAdd(column[i], hn::Set(d, L[i][j]), column[j]);
            }
            for (int j = 0; j < n; ++j) hn::Store(column[j], d, x + j * P);
        }
    }
}

/// Calls work(begin, end) on ranges of packets, in parallel if there is enough work.
template <class Work>
void share(int begin, int end, double work_of_each, const Work& work) {
    if (end <= begin) return;
    const int grain = std::max(static_cast<int>(work_to_share / work_of_each), tile_packets) / tile_packets;
    parallel_for(static_cast<std::size_t>(end - begin), static_cast<std::size_t>(grain) * tile_packets,
                 [&](std::size_t b, std::size_t e) { work(begin + static_cast<int>(b), begin + static_cast<int>(e)); });
}

template <class Real>
bool factorise_panel(const Panel<Real>& panel) {
    constexpr int P = packet<Real>;
    const int packets = panel.rows() / P;
    for (int first = 0; first < panel.columns; first += slab) {
        const int width = std::min(slab, panel.columns - first);
        const int below = (first + width + P - 1) / P;
        Real L[slab][slab];
        Real inverse[slab];
        if (first > 0) subtract_left(panel, first, width, first / P, below);
        if (!factorise_block(panel, first, width, L, inverse)) return false;
        share(below, packets, static_cast<double>(P) * width * (first + width), [&](int begin, int end) {
            if (first > 0) subtract_left(panel, first, width, begin, end);
            if (width == slab)
                divide_packets<slab>(panel, first, width, L, inverse, begin, end);
            else
                divide_packets<0>(panel, first, width, L, inverse, begin, end);
        });
    }
    return true;
}

template <class Real>
void negative_panel_product(const Panel<Real>& panel, Real* update) {
    constexpr int P = packet<Real>;
    const std::size_t stride = static_cast<std::size_t>(panel.columns) * P;
    const Real* rows = panel.values + static_cast<std::size_t>(panel.first_below() / P) * stride;
    const int packets = whole_packets<Real>(panel.below) / P;
    const std::size_t leading = static_cast<std::size_t>(packets) * P;
    const auto strip = [&](int column, int from, int depth) {
        const Real* b = rows + static_cast<std::size_t>(column / P) * stride + static_cast<std::size_t>(from) * P;
        const auto run = [&](auto to) {
            subtract_strip<decltype(to)::value>(rows + static_cast<std::size_t>(from) * P, stride, b + column % P,
                                                depth, update + static_cast<std::size_t>(column) * leading,
                                                static_cast<std::size_t>(P), leading,
                                                std::min(tile_columns, panel.below - column), column / P, packets);
        };
        if (from == 0)
            run(std::integral_constant<To, To::store>{});
        else
            run(std::integral_constant<To, To::subtract>{});
    };
    const double work_of_each = 0.5 * P * panel.below * static_cast<double>(panel.columns);
    share(0, packets, work_of_each, [&](int begin, int end) {
        for (int from = 0; from < panel.columns; from += product_depth) {
            const int depth = std::min(product_depth, panel.columns - from);
            for (int column = begin * P; column < std::min(end * P, panel.below); column += tile_columns)
                strip(column, from, depth);
        }
    });
}

// Non-template names for the dispatch table below.
bool factorise_double(const Panel<double>& p) {
    return factorise_panel(p);
}
bool factorise_float(const Panel<float>& p) {
    return factorise_panel(p);
}
void product_double(const Panel<double>& p, double* u) {
    negative_panel_product(p, u);
}
void product_float(const Panel<float>& p, float* u) {
    negative_panel_product(p, u);
}

}  // namespace pliant::linalg::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pliant::linalg {

HWY_EXPORT(factorise_double);
HWY_EXPORT(factorise_float);
HWY_EXPORT(product_double);
HWY_EXPORT(product_float);

template <>
bool factorise(const Panel<double>& panel) {
    return HWY_DYNAMIC_DISPATCH(factorise_double)(panel);
}
template <>
bool factorise(const Panel<float>& panel) {
    return HWY_DYNAMIC_DISPATCH(factorise_float)(panel);
}
template <>
void negative_product(const Panel<double>& panel, double* update) {
    HWY_DYNAMIC_DISPATCH(product_double)(panel, update);
}
template <>
void negative_product(const Panel<float>& panel, float* update) {
    HWY_DYNAMIC_DISPATCH(product_float)(panel, update);
}

}  // namespace pliant::linalg
#endif
