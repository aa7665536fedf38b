// Compiled once for each instruction set; the best one available is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/linalg/row_products.cpp"
#include "base/linalg/row_products.hpp"

#include <hwy/foreach_target.h>
// Must follow foreach_target.
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace pliant::linalg::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Prefetch distance in entries. They are contiguous, but hardware prefetchers stop at page boundaries.
constexpr std::size_t ahead = 80;

/// Four rows of a column, the last one unused, in as many vectors as needed.
template <class Real>
struct Column {
    using D = hn::CappedTag<Real, 4>;
    static constexpr std::size_t width = hn::MaxLanes(D());
    static constexpr std::size_t parts = 4 / width;
    hn::Vec<D> part[parts];

    HWY_INLINE Column() {
        for (auto& p : part) p = hn::Zero(D());
    }
    HWY_INLINE void add_product(const RowBlocks& matrix, std::size_t at, Real x) {
        const auto factor = hn::Set(D(), x);
        for (std::size_t p = 0; p < parts; ++p) part[p] = hn::MulAdd(load(matrix, at + p * width), factor, part[p]);
    }
    HWY_INLINE void add(const Column& other) {
        for (std::size_t p = 0; p < parts; ++p) part[p] = hn::Add(part[p], other.part[p]);
    }
    HWY_INLINE void store(Real* three) const {
        HWY_ALIGN Real four[4];
        for (std::size_t p = 0; p < parts; ++p) hn::Store(part[p], D(), four + p * width);
        std::copy_n(four, 3, three);
    }

private:
    static HWY_INLINE hn::Vec<D> load(const RowBlocks& matrix, std::size_t at) {
        if constexpr (sizeof(Real) == sizeof(float)) {
            return hn::LoadU(D(), matrix.value + at);
        } else {
            const hn::Rebind<float, D> half;
            return hn::Add(hn::PromoteTo(D(), hn::LoadU(half, matrix.value + at)),
                           hn::PromoteTo(D(), hn::LoadU(half, matrix.rest + at)));
        }
    }
};

template <class Real>
void multiply_any(const RowBlocks& matrix, std::size_t begin, std::size_t end, const Real* x, Real* y) {
    for (std::size_t i = begin; i < end; ++i) {
        Column<Real> first, second, third;  // independent sums, to hide latency
        for (int k = matrix.start[i]; k < matrix.start[i + 1]; ++k) {
            const std::size_t at = 9 * static_cast<std::size_t>(k);
            const Real* v = x + 3 * static_cast<std::size_t>(matrix.column[k]);
            hwy::Prefetch(matrix.value + at + 9 * ahead);
            if constexpr (sizeof(Real) > sizeof(float)) hwy::Prefetch(matrix.rest + at + 9 * ahead);
            first.add_product(matrix, at, v[0]);
            second.add_product(matrix, at + 3, v[1]);
            third.add_product(matrix, at + 6, v[2]);
        }
        first.add(second);
        first.add(third);
        first.store(y + 3 * i);
    }
}

/// Four rows of a column for two interleaved vectors.
template <class Real>
using Both = hn::CappedTag<Real, 8>;

template <class Real>
HWY_INLINE hn::Vec<Both<Real>> load_for_both(const RowBlocks& matrix, std::size_t at) {
    const Both<Real> d;
    if constexpr (sizeof(Real) == sizeof(float)) {
        return hn::LoadDup128(d, matrix.value + at);
    } else {
        const hn::Rebind<float, Both<Real>> half;
        return hn::Add(hn::PromoteTo(d, hn::LoadDup128(half, matrix.value + at)),
                       hn::PromoteTo(d, hn::LoadDup128(half, matrix.rest + at)));
    }
}

/// Two interleaved vectors: each block is read once for both.
template <class Real>
void multiply_two(const RowBlocks& matrix, std::size_t begin, std::size_t end, const Real* x, Real* y) {
    const Both<Real> d;
    using Index = hn::TFromD<hn::RebindToSigned<Both<Real>>>;
    HWY_ALIGN static constexpr Index places[3][8] = {
        {0, 0, 0, 0, 1, 1, 1, 1}, {2, 2, 2, 2, 3, 3, 3, 3}, {4, 4, 4, 4, 5, 5, 5, 5}};
    const auto of_first = hn::SetTableIndices(d, places[0]), of_second = hn::SetTableIndices(d, places[1]);
    const auto of_third = hn::SetTableIndices(d, places[2]);
    for (std::size_t i = begin; i < end; ++i) {
        auto first = hn::Zero(d), second = hn::Zero(d), third = hn::Zero(d);
        for (int k = matrix.start[i]; k < matrix.start[i + 1]; ++k) {
            const std::size_t at = 9 * static_cast<std::size_t>(k);
            hwy::Prefetch(matrix.value + at + 9 * ahead);
            if constexpr (sizeof(Real) > sizeof(float)) hwy::Prefetch(matrix.rest + at + 9 * ahead);
            const auto v = hn::LoadU(d, x + 6 * static_cast<std::size_t>(matrix.column[k]));
            first = hn::MulAdd(load_for_both<Real>(matrix, at), hn::TableLookupLanes(v, of_first), first);
            second = hn::MulAdd(load_for_both<Real>(matrix, at + 3), hn::TableLookupLanes(v, of_second), second);
            third = hn::MulAdd(load_for_both<Real>(matrix, at + 6), hn::TableLookupLanes(v, of_third), third);
        }
        HWY_ALIGN Real sums[8];
        hn::Store(hn::Add(hn::Add(first, second), third), d, sums);
        for (std::size_t r = 0; r < 3; ++r) {
            y[6 * i + 2 * r] = sums[r];
            y[6 * i + 2 * r + 1] = sums[4 + r];
        }
    }
}

/// The same for SIMD registers that are too short for two; added up in the same order, so that the bits are the same.
template <class Real>
void multiply_each(const RowBlocks& matrix, std::size_t begin, std::size_t end, const Real* x, Real* y) {
    for (std::size_t i = begin; i < end; ++i) {
        Column<Real> first[2], second[2], third[2];
        for (int k = matrix.start[i]; k < matrix.start[i + 1]; ++k) {
            const std::size_t at = 9 * static_cast<std::size_t>(k);
            const Real* v = x + 6 * static_cast<std::size_t>(matrix.column[k]);
            hwy::Prefetch(matrix.value + at + 9 * ahead);
            if constexpr (sizeof(Real) > sizeof(float)) hwy::Prefetch(matrix.rest + at + 9 * ahead);
            for (std::size_t which = 0; which < 2; ++which) {
                first[which].add_product(matrix, at, v[which]);
                second[which].add_product(matrix, at + 3, v[2 + which]);
                third[which].add_product(matrix, at + 6, v[4 + which]);
            }
        }
        for (std::size_t which = 0; which < 2; ++which) {
            Real three[3];
            first[which].add(second[which]);
            first[which].add(third[which]);
            first[which].store(three);
            for (std::size_t r = 0; r < 3; ++r) y[6 * i + 2 * r + which] = three[r];
        }
    }
}

template <class Real>
void multiply_columns(const RowBlocks& matrix, std::size_t begin, std::size_t end, int columns, const Real* x,
                      Real* y) {
    if (columns == 1) return multiply_any(matrix, begin, end, x, y);
    if constexpr (hn::MaxLanes(Both<Real>()) == 8)
        multiply_two(matrix, begin, end, x, y);
    else
        multiply_each(matrix, begin, end, x, y);
}

void multiply_double(const RowBlocks& matrix, std::size_t begin, std::size_t end, int columns, const double* x,
                     double* y) {
    multiply_columns(matrix, begin, end, columns, x, y);
}
void multiply_float(const RowBlocks& matrix, std::size_t begin, std::size_t end, int columns, const float* x,
                    float* y) {
    multiply_columns(matrix, begin, end, columns, x, y);
}

}  // namespace pliant::linalg::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pliant::linalg {

HWY_EXPORT(multiply_double);
HWY_EXPORT(multiply_float);

void multiply_rows(const RowBlocks& matrix, std::size_t begin, std::size_t end, int columns, const double* x,
                   double* y) {
    HWY_DYNAMIC_DISPATCH(multiply_double)(matrix, begin, end, columns, x, y);
}
void multiply_rows(const RowBlocks& matrix, std::size_t begin, std::size_t end, int columns, const float* x, float* y) {
    HWY_DYNAMIC_DISPATCH(multiply_float)(matrix, begin, end, columns, x, y);
}

}  // namespace pliant::linalg
#endif
