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

void column_to_corners(const LowerTriangle& matrix, int node, double weight, const Followers& followers,
                       const int* place, double* sums) {
    const Lanes d;
    const hn::Rebind<float, Lanes> half;
    for (int k = matrix.start[node]; k < matrix.start[node + 1]; ++k) {
        const int row = matrix.row[k];
        const std::array<int, 2>& ends = followers.ends[row];
        const double factor = (row == node ? 0.5 : 1) * weight * followers.share(row);
        const auto factors = hn::Set(d, factor);
        const float* value = matrix.value + 9 * static_cast<std::size_t>(k);
        const float* rest = matrix.rest + 9 * static_cast<std::size_t>(k);
        for (std::size_t e = ends[0] == ends[1] ? 1 : 0; e < 2; ++e) {
            if (ends[e] < 0) continue;
            double* const sum = sums + 9 * static_cast<std::size_t>(place[ends[e]]);
            for (std::size_t q = 0; q < 8; q += hn::MaxLanes(d)) {
                const auto block =
                    hn::Add(hn::PromoteTo(d, hn::LoadU(half, value + q)), hn::PromoteTo(d, hn::LoadU(half, rest + q)));
                hn::StoreU(hn::MulAdd(factors, block, hn::LoadU(d, sum + q)), d, sum + q);
            }
            sum[8] += factor * (static_cast<double>(value[8]) + static_cast<double>(rest[8]));
        }
    }
}

}  // namespace pliant::linalg::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pliant::linalg {

HWY_EXPORT(column_to_corners);

void add_column_to_corners(const LowerTriangle& matrix, int node, double weight, const Followers& followers,
                           const int* place, double* sums) {
    HWY_DYNAMIC_DISPATCH(column_to_corners)(matrix, node, weight, followers, place, sums);
}

}  // namespace pliant::linalg
#endif
