// Compiled once for each instruction set; the one that the machine has is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/linalg/row_products.cpp"
#include "base/linalg/row_products.hpp"

#include <hwy/foreach_target.h>
// After foreach_target, as it asks.
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace pliant::linalg::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Entries ahead of the one in question whose numbers are called from memory. They lie in a row, but processors look no
/// further than a page.
constexpr std::size_t ahead = 80;

/// Four rows of a column, of which the last is of no use, in as many vectors as it takes.
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
        Column<Real> first, second, third;  // sums that need not wait for one another
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

void multiply_double(const RowBlocks& matrix, std::size_t begin, std::size_t end, const double* x, double* y) {
    multiply_any(matrix, begin, end, x, y);
}
void multiply_float(const RowBlocks& matrix, std::size_t begin, std::size_t end, const float* x, float* y) {
    multiply_any(matrix, begin, end, x, y);
}

}  // namespace pliant::linalg::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pliant::linalg {

HWY_EXPORT(multiply_double);
HWY_EXPORT(multiply_float);

void multiply_rows(const RowBlocks& matrix, std::size_t begin, std::size_t end, const double* x, double* y) {
    HWY_DYNAMIC_DISPATCH(multiply_double)(matrix, begin, end, x, y);
}
void multiply_rows(const RowBlocks& matrix, std::size_t begin, std::size_t end, const float* x, float* y) {
    HWY_DYNAMIC_DISPATCH(multiply_float)(matrix, begin, end, x, y);
}

}  // namespace pliant::linalg
#endif
