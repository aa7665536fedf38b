// Compiled once for each instruction set; the best one available is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/linalg/symmetric_product.cpp"
#include "base/linalg/symmetric_product.hpp"

#include <hwy/foreach_target.h>
// Must follow foreach_target.
#include <hwy/highway.h>

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace pliant::linalg::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Four numbers, of which the last is not used, in as many vectors as needed.
struct Four {
    using D = hn::CappedTag<double, 4>;
    static constexpr std::size_t width = hn::MaxLanes(D());
    static constexpr std::size_t parts = 4 / width;
    hn::Vec<D> part[parts];

    static HWY_INLINE Four zero() {
        Four four;
        for (auto& p : four.part) p = hn::Zero(D());
        return four;
    }
    static HWY_INLINE Four all(double number) {
        Four four;
        for (auto& p : four.part) p = hn::Set(D(), number);
        return four;
    }
    static HWY_INLINE Four load(const double* from) {
        Four four;
        for (std::size_t p = 0; p < parts; ++p) four.part[p] = hn::Load(D(), from + p * width);
        return four;
    }
    /// A column of a block, and the number behind it.
    static HWY_INLINE Four load_column(const double* from) {
        Four four;
        for (std::size_t p = 0; p < parts; ++p) four.part[p] = hn::LoadU(D(), from + p * width);
        return four;
    }
    /// A column behind which there is nothing.
    static HWY_INLINE Four load_last_column(const double* from) {
        HWY_ALIGN const double copy[4] = {from[0], from[1], from[2], 0};
        return load(copy);
    }
    HWY_INLINE void store(double* to) const {
        for (std::size_t p = 0; p < parts; ++p) hn::Store(part[p], D(), to + p * width);
    }
    HWY_INLINE void add_product(const Four& a, const Four& b) {
        for (std::size_t p = 0; p < parts; ++p) part[p] = hn::MulAdd(a.part[p], b.part[p], part[p]);
    }
    [[nodiscard]] HWY_INLINE double sum() const {
        double sum = 0;
        for (const auto& p : part) sum += hn::GetLane(hn::SumOfLanes(D(), p));
        return sum;
    }
};

/// The lower triangle of a diagonal block times v.
HWY_INLINE void add_diagonal(const double* B, const double* v, double* product) {
    product[0] += B[0] * v[0] + B[1] * v[1] + B[2] * v[2];
    product[1] += B[1] * v[0] + B[4] * v[1] + B[5] * v[2];
    product[2] += B[2] * v[0] + B[5] * v[1] + B[8] * v[2];
}

void symmetric_product(const SymmetricPattern& pattern, const double* values, const double* v, double* product) {
    const int blocks = static_cast<int>(pattern.node_row.size());
    for (int j = 0; j < pattern.nodes; ++j) {
        const double* of_j = v + 4 * static_cast<std::size_t>(j);
        const Four x = Four::all(of_j[0]), y = Four::all(of_j[1]), z = Four::all(of_j[2]);
        Four by_x = Four::zero(), by_y = Four::zero(), by_z = Four::zero();  // the transposed blocks times v
        const int diagonal = pattern.node_start[j];
        for (int k = diagonal + 1; k < pattern.node_start[j + 1]; ++k) {
            const double* block = values + 9 * static_cast<std::size_t>(k);
            const std::size_t at = 4 * static_cast<std::size_t>(pattern.node_row[k]);
            const Four of_x = Four::load_column(block), of_y = Four::load_column(block + 3);
            const Four of_z = k + 1 < blocks ? Four::load_column(block + 6) : Four::load_last_column(block + 6);
            const Four of_i = Four::load(v + at);
            by_x.add_product(of_x, of_i);
            by_y.add_product(of_y, of_i);
            by_z.add_product(of_z, of_i);
            Four sum = Four::load(product + at);
            sum.add_product(of_x, x);
            sum.add_product(of_y, y);
            sum.add_product(of_z, z);
            sum.store(product + at);
        }
        double* to = product + 4 * static_cast<std::size_t>(j);
        to[0] += by_x.sum();
        to[1] += by_y.sum();
        to[2] += by_z.sum();
        add_diagonal(values + 9 * static_cast<std::size_t>(diagonal), of_j, to);
    }
}

}  // namespace pliant::linalg::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pliant::linalg {

HWY_EXPORT(symmetric_product);

void add_symmetric_product(const SymmetricPattern& pattern, const double* values, const double* v, double* product) {
    HWY_DYNAMIC_DISPATCH(symmetric_product)(pattern, values, v, product);
}

}  // namespace pliant::linalg
#endif
