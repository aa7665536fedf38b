// Compiled once for each instruction set; the best one available is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/linalg/panel.cpp"
#include "base/linalg/panel.hpp"

#include <hwy/foreach_target.h>
// Must follow foreach_target.
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>
#include <vector>

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
/// Minimum numbers of a factor, each read once, for using another core.
constexpr int reading_to_share = 50000;
/// Minimum numbers of an update to add for using another core.
constexpr std::size_t additions_to_share = 50000;

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

/// The same for items that are read once, of `entries` numbers each.
template <class Work>
void share_reading(int begin, int end, int entries, const Work& work) {
    if (end <= begin) return;
    const auto grain = static_cast<std::size_t>(std::max(reading_to_share / std::max(entries, 1), 4) / 4 * 4);
    parallel_for(static_cast<std::size_t>(end - begin), grain,
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

/// target += source, `count` numbers.
template <class Real>
HWY_INLINE void add_numbers(const Real* source, int count, Real* target) {
    const hn::CappedTag<Real, packet<Real>> d;
    constexpr int N = static_cast<int>(hn::MaxLanes(d));
    int r = 0;
    for (; r + N <= count; r += N)
        hn::StoreU(hn::Add(hn::LoadU(d, target + r), hn::LoadU(d, source + r)), d, target + r);
    if constexpr (HWY_TARGET <= HWY_AVX3) {
        const auto rest = hn::FirstN(d, static_cast<std::size_t>(count - r));
        const auto sum = hn::Add(hn::MaskedLoad(rest, d, target + r), hn::MaskedLoad(rest, d, source + r));
        hn::BlendedStore(sum, rest, d, target + r);
    } else {
        for (; r < count; ++r) target[r] += source[r];
    }
}

/// The lower triangle of `from`, column by column: add(source, column, row, count) gets the numbers of unknowns `row`
/// .. `row + count` and `column` of the front. Only columns of the stretches begin .. end.
template <class Real, class Add>
void add_columns(const Real* from, std::size_t leading, std::span<const Stretch> stretches, std::size_t begin,
                 std::size_t end, int block, const Add& add) {
    const auto add_column = [&](std::size_t part, int c) {
        const Real* source = from + static_cast<std::size_t>(stretches[part].from * block + c) * leading;
        const int column = stretches[part].to * block + c;
        for (std::size_t q = part; q < stretches.size(); ++q) {
            const int skip = q == part ? c : 0;
            add(source + stretches[q].from * block + skip, column, stretches[q].to * block + skip,
                stretches[q].length * block - skip);
        }
    };
    std::size_t columns = 0;
    for (std::size_t part = begin; part < end; ++part)
        columns += static_cast<std::size_t>(stretches[part].length * block);
    if (columns * leading < 2 * additions_to_share) {
        for (std::size_t part = begin; part < end; ++part) {
            for (int c = 0; c < stretches[part].length * block; ++c) add_column(part, c);
        }
        return;
    }
    std::vector<std::pair<std::size_t, int>> each;
    for (std::size_t part = begin; part < end; ++part) {
        for (int c = 0; c < stretches[part].length * block; ++c) each.emplace_back(part, c);
    }
    parallel_for(each.size(), additions_to_share / leading + 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k) add_column(each[k].first, each[k].second);
    });
}

/// The first stretch that does not belong to the panel's own nodes.
template <class Real>
std::size_t first_passed_on(std::span<const Stretch> stretches, int block, const Panel<Real>& panel) {
    const auto own = [&](const Stretch& part) { return part.to * block < panel.columns; };
    return static_cast<std::size_t>(std::find_if_not(stretches.begin(), stretches.end(), own) - stretches.begin());
}

template <class Real>
void add_to_panel_any(const Real* from, std::size_t leading, std::span<const Stretch> stretches, int block,
                      const Panel<Real>& panel) {
    constexpr int P = packet<Real>;
    const std::size_t stride = static_cast<std::size_t>(panel.columns) * P;
    const auto add = [&](const Real* source, int column, int row, int count) {
        if (row >= panel.columns) row += panel.first_below() - panel.columns;
        Real* target = panel.at(row, column);
        for (int in_packet = row % P; count > 0; in_packet = 0) {
            const int now = std::min(count, P - in_packet);
            add_numbers(source, now, target);
            source += now;
            count -= now;
            target += stride - static_cast<std::size_t>(in_packet);
        }
    };
    add_columns(from, leading, stretches, 0, first_passed_on(stretches, block, panel), block, add);
}

template <class Real>
void add_to_update_any(const Real* from, std::size_t leading, std::span<const Stretch> stretches, int block,
                       const Panel<Real>& panel, Real* update) {
    const auto to_leading = static_cast<std::size_t>(whole_packets<Real>(panel.below));
    const auto add = [&](const Real* source, int column, int row, int count) {
        add_numbers(source, count,
                    update + static_cast<std::size_t>(column - panel.columns) * to_leading + row - panel.columns);
    };
    add_columns(from, leading, stretches, first_passed_on(stretches, block, panel), stretches.size(), block, add);
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
void add_to_panel_double(const double* from, std::size_t leading, std::span<const Stretch> stretches, int block,
                         const Panel<double>& panel) {
    add_to_panel_any(from, leading, stretches, block, panel);
}
void add_to_panel_float(const float* from, std::size_t leading, std::span<const Stretch> stretches, int block,
                        const Panel<float>& panel) {
    add_to_panel_any(from, leading, stretches, block, panel);
}
void add_to_update_double(const double* from, std::size_t leading, std::span<const Stretch> stretches, int block,
                          const Panel<double>& panel, double* update) {
    add_to_update_any(from, leading, stretches, block, panel, update);
}
void add_to_update_float(const float* from, std::size_t leading, std::span<const Stretch> stretches, int block,
                         const Panel<float>& panel, float* update) {
    add_to_update_any(from, leading, stretches, block, panel, update);
}
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

HWY_EXPORT(factorise_double);
HWY_EXPORT(factorise_float);
HWY_EXPORT(product_double);
HWY_EXPORT(product_float);
HWY_EXPORT(add_to_panel_double);
HWY_EXPORT(add_to_panel_float);
HWY_EXPORT(add_to_update_double);
HWY_EXPORT(add_to_update_float);
HWY_EXPORT(lower_double);
HWY_EXPORT(lower_float);
HWY_EXPORT(upper_double);
HWY_EXPORT(upper_float);
HWY_EXPORT(lane_products_double);
HWY_EXPORT(lane_products_float);
HWY_EXPORT(lower_lanes_double);
HWY_EXPORT(lower_lanes_float);
HWY_EXPORT(upper_lanes_double);
HWY_EXPORT(upper_lanes_float);

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
template <>
void add_to_panel(const double* from, std::size_t leading, std::span<const Stretch> stretches, int block,
                  const Panel<double>& panel) {
    HWY_DYNAMIC_DISPATCH(add_to_panel_double)(from, leading, stretches, block, panel);
}
template <>
void add_to_panel(const float* from, std::size_t leading, std::span<const Stretch> stretches, int block,
                  const Panel<float>& panel) {
    HWY_DYNAMIC_DISPATCH(add_to_panel_float)(from, leading, stretches, block, panel);
}
template <>
void add_to_update(const double* from, std::size_t leading, std::span<const Stretch> stretches, int block,
                   const Panel<double>& panel, double* update) {
    HWY_DYNAMIC_DISPATCH(add_to_update_double)(from, leading, stretches, block, panel, update);
}
template <>
void add_to_update(const float* from, std::size_t leading, std::span<const Stretch> stretches, int block,
                   const Panel<float>& panel, float* update) {
    HWY_DYNAMIC_DISPATCH(add_to_update_float)(from, leading, stretches, block, panel, update);
}
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
