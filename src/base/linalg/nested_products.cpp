// Compiled once for each instruction set; the best one available is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/linalg/nested_products.cpp"
#include "base/linalg/nested_products.hpp"

#include <hwy/foreach_target.h>
// Must follow foreach_target.
#include <hwy/highway.h>

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace pliant::linalg::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// The first eight of a block's nine numbers, in as many vectors as needed; the ninth by itself.
using Lanes = hn::CappedTag<double, 8>;

/// Adds a block to the sums of the coarse nodes that its node `other` follows.
HWY_INLINE void add_block(const LowerTriangle& matrix, int pair, int other, double weight, const Followers& followers,
                          const CornerSums& to, double* sums) {
    const Lanes d;
    const hn::Rebind<float, Lanes> half;
    const std::array<int, 2>& ends = followers.ends[other];
    const double factor = weight * followers.share(other);
    const auto factors = hn::Set(d, factor);
    const float* value = matrix.value + 9 * static_cast<std::size_t>(pair);
    const float* rest = matrix.rest + 9 * static_cast<std::size_t>(pair);
    for (std::size_t e = ends[0] == ends[1] ? 1 : 0; e < 2; ++e) {
        if (ends[e] < to.first) continue;
        double* const sum = sums + 9 * static_cast<std::size_t>(to.place[ends[e]]);
        for (std::size_t q = 0; q < 8; q += hn::MaxLanes(d)) {
            const auto block =
                hn::Add(hn::PromoteTo(d, hn::LoadU(half, value + q)), hn::PromoteTo(d, hn::LoadU(half, rest + q)));
            hn::StoreU(hn::MulAdd(factors, block, hn::LoadU(d, sum + q)), d, sum + q);
        }
        sum[8] += factor * (static_cast<double>(value[8]) + static_cast<double>(rest[8]));
    }
}

void column_to_corners(const LowerTriangle& matrix, int node, double weight, const Followers& followers,
                       const CornerSums& sums) {
    for (int e = matrix.left_start[node]; e < matrix.left_start[node + 1]; ++e)
        add_block(matrix, matrix.left_pair[e], matrix.left_column[e], weight, followers, sums, sums.mirrored);
    for (int k = matrix.start[node]; k < matrix.start[node + 1]; ++k)
        add_block(matrix, k, matrix.row[k], weight, followers, sums, sums.below);
}

}  // namespace pliant::linalg::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pliant::linalg {

HWY_EXPORT(column_to_corners);

void add_to_corners(const LowerTriangle& matrix, int node, double weight, const Followers& followers,
                    const CornerSums& sums) {
    HWY_DYNAMIC_DISPATCH(column_to_corners)(matrix, node, weight, followers, sums);
}

}  // namespace pliant::linalg
#endif
