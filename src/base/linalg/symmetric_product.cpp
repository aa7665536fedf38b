// Compiled once for each instruction set; the best one available is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/linalg/symmetric_product.cpp"
#include "base/linalg/symmetric_product.hpp"

#include <hwy/foreach_target.h>
// Must follow foreach_target.
#include <hwy/cache_control.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pliant::linalg::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Prefetch distance in blocks. They are contiguous, but hardware prefetchers stop at page boundaries.
constexpr std::size_t ahead = 80;

/// For each of one or two columns the three numbers of a node and a fourth, in as many vectors as needed.
template <class Real, std::size_t columns>
struct Fours {
    using D = hn::CappedTag<Real, 4 * columns>;
    static constexpr std::size_t width = hn::MaxLanes(D());
    static constexpr std::size_t parts = 4 * columns / width;
    hn::Vec<D> part[parts];

    static HWY_INLINE Fours zero() {
        Fours fours;
        for (auto& p : fours.part) p = hn::Zero(D());
        return fours;
    }
    static HWY_INLINE Fours load(const Real* from) {
        Fours fours;
        for (std::size_t p = 0; p < parts; ++p) fours.part[p] = hn::Load(D(), from + p * width);
        return fours;
    }
    /// Component `c` of each column, four times.
    static HWY_INLINE Fours repeated(const Real* from, std::size_t c) {
        HWY_ALIGN Real wide[4 * columns];
        for (std::size_t k = 0; k < 4 * columns; ++k) wide[k] = from[k / 4 * 4 + c];
        return load(wide);
    }
    HWY_INLINE void store(Real* to) const {
        for (std::size_t p = 0; p < parts; ++p) hn::Store(part[p], D(), to + p * width);
    }
    HWY_INLINE void add(const Fours& other) {
        for (std::size_t p = 0; p < parts; ++p) part[p] = hn::Add(part[p], other.part[p]);
    }
    HWY_INLINE void add_product(const Fours& a, const Fours& b) {
        for (std::size_t p = 0; p < parts; ++p) part[p] = hn::MulAdd(a.part[p], b.part[p], part[p]);
    }
};

/// Blocks as doubles, as pairs of floats whose sum counts, or as floats. four(d, at, p) loads part p of the number `at`
/// and the three behind it, again for each column.
struct Doubles {
    static constexpr bool end_sharply = true;  ///< nothing may be read behind the last number
    const double* number;

    template <class D>
    HWY_INLINE hn::Vec<D> four(D d, std::size_t at, std::size_t p) const {
        return hn::LoadU(d, number + at + p * hn::MaxLanes(d) % 4);
    }
    HWY_INLINE double one(std::size_t at) const { return number[at]; }
    HWY_INLINE void prefetch(std::size_t at) const { hwy::Prefetch(number + at); }
};

template <class D>
HWY_INLINE hn::Vec<D> load_four(D d, const float* from, std::size_t p) {
    if constexpr (hn::MaxLanes(d) == 8)
        return hn::LoadDup128(d, from);
    else
        return hn::LoadU(d, from + p * hn::MaxLanes(d) % 4);
}

struct Floats {
    static constexpr bool end_sharply = false;
    const float* number;

    template <class D>
    HWY_INLINE hn::Vec<D> four(D d, std::size_t at, std::size_t p) const {
        return load_four(d, number + at, p);
    }
    HWY_INLINE float one(std::size_t at) const { return number[at]; }
    HWY_INLINE void prefetch(std::size_t at) const { hwy::Prefetch(number + at); }
};

struct Sums {
    static constexpr bool end_sharply = false;
    SplitBlocks blocks;

    template <class D>
    HWY_INLINE hn::Vec<D> four(D d, std::size_t at, std::size_t p) const {
        const hn::Rebind<float, D> half;
        return hn::Add(hn::PromoteTo(d, load_four(half, blocks.value + at, p)),
                       hn::PromoteTo(d, load_four(half, blocks.rest + at, p)));
    }
    HWY_INLINE double one(std::size_t at) const {
        return static_cast<double>(blocks.value[at]) + static_cast<double>(blocks.rest[at]);
    }
    HWY_INLINE void prefetch(std::size_t at) const {
        hwy::Prefetch(blocks.value + at);
        hwy::Prefetch(blocks.rest + at);
    }
};

/// The three columns of a block, for each column of v.
template <class Real, std::size_t columns>
struct Block {
    using Column = Fours<Real, columns>;
    Column x, y, z;

    template <class Blocks>
    static HWY_INLINE Block load(const Blocks& blocks, std::size_t k) {
        Block block;
        for (std::size_t p = 0; p < Column::parts; ++p) {
            block.x.part[p] = blocks.four(typename Column::D(), 9 * k, p);
            block.y.part[p] = blocks.four(typename Column::D(), 9 * k + 3, p);
            block.z.part[p] = blocks.four(typename Column::D(), 9 * k + 6, p);
        }
        return block;
    }
    /// The last block of an array behind which nothing may be read.
    static HWY_INLINE Block load_last(const Doubles& blocks, std::size_t k) {
        HWY_ALIGN double copy[12] = {};
        for (std::size_t q = 0; q < 9; ++q) copy[q] = blocks.one(9 * k + q);
        return load(Doubles{copy}, 0);
    }
};

/// The transposed blocks of a column times v: sums of which all lanes remain to be added. Independent, to hide latency.
template <class Real, std::size_t columns>
struct TransposedSums {
    Fours<Real, columns> x, y, z;

    static HWY_INLINE TransposedSums zero() {
        const auto none = Fours<Real, columns>::zero();
        return {none, none, none};
    }
    HWY_INLINE void add_product(const Block<Real, columns>& block, const Fours<Real, columns>& v) {
        x.add_product(block.x, v);
        y.add_product(block.y, v);
        z.add_product(block.z, v);
    }
    HWY_INLINE void add(const TransposedSums& other) {
        x.add(other.x);
        y.add(other.y);
        z.add(other.z);
    }
    /// to (columns, 4) += the sums.
    HWY_INLINE void add_to(Real* to) const {
        const Fours<Real, columns>* const sums[3] = {&x, &y, &z};
        for (std::size_t c = 0; c < 3; ++c) {
            HWY_ALIGN Real lanes[4 * columns];
            sums[c]->store(lanes);
            for (std::size_t k = 0; k < columns; ++k)
                to[4 * k + c] += lanes[4 * k] + lanes[4 * k + 1] + lanes[4 * k + 2] + lanes[4 * k + 3];
        }
    }
};

/// The lower triangle of a diagonal block times v.
template <class Real, std::size_t columns, class Blocks>
HWY_INLINE void add_diagonal(const Blocks& blocks, std::size_t k, const Real* v, Real* product) {
    const Real xx = blocks.one(9 * k), yx = blocks.one(9 * k + 1), zx = blocks.one(9 * k + 2);
    const Real yy = blocks.one(9 * k + 4), zy = blocks.one(9 * k + 5), zz = blocks.one(9 * k + 8);
    for (std::size_t c = 0; c < 4 * columns; c += 4) {
        product[c] += xx * v[c] + yx * v[c + 1] + zx * v[c + 2];
        product[c + 1] += yx * v[c] + yy * v[c + 1] + zy * v[c + 2];
        product[c + 2] += zx * v[c] + zy * v[c + 1] + zz * v[c + 2];
    }
}

template <class Real, std::size_t columns, class Blocks>
void add_product(const BlockColumns& at, const Blocks& blocks, const Real* v, Real* product) {
    using Numbers = Fours<Real, columns>;
    using Whole = Block<Real, columns>;
    constexpr std::size_t stride = 4 * columns;
    for (std::size_t j = 0; j < at.count; ++j) {
        const auto diagonal = static_cast<std::size_t>(at.start[j]), end = static_cast<std::size_t>(at.start[j + 1]);
        const std::size_t own = stride * static_cast<std::size_t>(at.place[diagonal]);
        const Numbers x = Numbers::repeated(v + own, 0), y = Numbers::repeated(v + own, 1);
        const Numbers z = Numbers::repeated(v + own, 2);
        auto even = TransposedSums<Real, columns>::zero(), odd = even;
        const auto add_block = [&](std::size_t k, const Whole& block, auto& transposed) HWY_ATTR {
            const std::size_t row = stride * static_cast<std::size_t>(at.place[k]);
            transposed.add_product(block, Numbers::load(v + row));
            Numbers sum = Numbers::load(product + row);
            sum.add_product(block.x, x);
            sum.add_product(block.y, y);
            sum.add_product(block.z, z);
            sum.store(product + row);
        };
        const std::size_t safe = Blocks::end_sharply && j + 1 == at.count ? end - 1 : end;
        std::size_t k = diagonal + 1;
        for (; k + 1 < safe; k += 2) {
            blocks.prefetch(9 * (k + ahead));
            blocks.prefetch(9 * (k + 1 + ahead));
            add_block(k, Whole::load(blocks, k), even);
            add_block(k + 1, Whole::load(blocks, k + 1), odd);
        }
        if (k < safe) {
            add_block(k, Whole::load(blocks, k), even);
            ++k;
        }
        if constexpr (Blocks::end_sharply) {
            if (k < end) add_block(k, Whole::load_last(blocks, k), even);
        }
        even.add(odd);
        even.add_to(product + own);
        add_diagonal<Real, columns>(blocks, diagonal, v + own, product + own);
    }
}

void product_of_doubles(const BlockColumns& at, const double* blocks, const double* v, double* product) {
    add_product<double, 1>(at, Doubles{blocks}, v, product);
}
void product_of_sums(const BlockColumns& at, const SplitBlocks& blocks, int columns, const double* v, double* product) {
    if (columns == 1)
        add_product<double, 1>(at, Sums{blocks}, v, product);
    else
        add_product<double, 2>(at, Sums{blocks}, v, product);
}
void product_of_floats(const BlockColumns& at, const float* blocks, int columns, const float* v, float* product) {
    if (columns == 1)
        add_product<float, 1>(at, Floats{blocks}, v, product);
    else
        add_product<float, 2>(at, Floats{blocks}, v, product);
}

void split_numbers(const double* numbers, std::size_t count, float* value, float* rest) {
    const hn::CappedTag<double, 8> d;
    const hn::Rebind<float, decltype(d)> half;
    std::size_t k = 0;
    for (; k + hn::MaxLanes(d) <= count; k += hn::MaxLanes(d)) {
        const auto number = hn::LoadU(d, numbers + k);
        const auto rounded = hn::DemoteTo(half, number);
        hn::StoreU(rounded, half, value + k);
        hn::StoreU(hn::DemoteTo(half, hn::Sub(number, hn::PromoteTo(d, rounded))), half, rest + k);
    }
    for (; k < count; ++k) {
        value[k] = static_cast<float>(numbers[k]);
        rest[k] = static_cast<float>(numbers[k] - static_cast<double>(value[k]));
    }
}

}  // namespace pliant::linalg::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pliant::linalg {

HWY_EXPORT(product_of_doubles);
HWY_EXPORT(product_of_sums);
HWY_EXPORT(product_of_floats);
HWY_EXPORT(split_numbers);

void add_symmetric_product(const BlockColumns& at, const double* blocks, const double* v, double* product) {
    HWY_DYNAMIC_DISPATCH(product_of_doubles)(at, blocks, v, product);
}
void add_symmetric_product(const BlockColumns& at, const SplitBlocks& blocks, int columns, const double* v,
                           double* product) {
    HWY_DYNAMIC_DISPATCH(product_of_sums)(at, blocks, columns, v, product);
}
void add_symmetric_product(const BlockColumns& at, const float* blocks, int columns, const float* v, float* product) {
    HWY_DYNAMIC_DISPATCH(product_of_floats)(at, blocks, columns, v, product);
}
void split(const double* numbers, std::size_t count, float* value, float* rest) {
    HWY_DYNAMIC_DISPATCH(split_numbers)(numbers, count, value, rest);
}

}  // namespace pliant::linalg
#endif
