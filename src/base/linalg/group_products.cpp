// Compiled once for each instruction set; the best one available is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/linalg/group_products.cpp"
#include "base/linalg/group_products.hpp"

#include <hwy/foreach_target.h>
// Must follow foreach_target.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pliant::linalg::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<double, modes_stored>;

/// A row of six numbers in as many vectors as needed.
struct Row {
    static constexpr std::size_t width = hn::MaxLanes(Lanes());
    static constexpr std::size_t parts = (GroupMotions::modes + width - 1) / width;
    hn::Vec<Lanes> part[parts];

    static HWY_INLINE Row load(const double* from) {
        Row row;
        for (std::size_t p = 0; p < parts; ++p) row.part[p] = hn::LoadU(Lanes(), from + p * width);
        return row;
    }
    HWY_INLINE void store(double* to) const {
        for (std::size_t p = 0; p < parts; ++p) hn::StoreU(part[p], Lanes(), to + p * width);
    }
    HWY_INLINE void add_product(double factor, const Row& other) {
        const auto all = hn::Set(Lanes(), factor);
        for (std::size_t p = 0; p < parts; ++p) part[p] = hn::MulAdd(all, other.part[p], part[p]);
    }
};

/// to + 3 by 6 += factors (3 by 3, by rows) * rows.
HWY_INLINE void add_block(const double* factors, const Row* rows, double* to) {
    for (std::size_t r = 0; r < 3; ++r) {
        Row sum = Row::load(to + r * modes_stored);
        for (std::size_t c = 0; c < 3; ++c) sum.add_product(factors[3 * r + c], rows[c]);
        sum.store(to + r * modes_stored);
    }
}

void forces_of_group(const LowerTriangle& matrix, const GroupMotions& motions, std::span<const MotionUse> uses,
                     const int* place, double* forces) {
    for (const MotionUse& use : uses) {
        const float* motion = motions.motion + 3 * GroupMotions::modes * static_cast<std::size_t>(use.entry);
        double by_rows[3][modes_stored] = {};
        for (std::size_t m = 0; m < GroupMotions::modes; ++m) {
            for (std::size_t r = 0; r < 3; ++r) by_rows[r][m] = static_cast<double>(motion[3 * m + r]);
        }
        const Row rows[3] = {Row::load(by_rows[0]), Row::load(by_rows[1]), Row::load(by_rows[2])};
        const auto force_on = [&](int node) {
            return forces + 3 * modes_stored * static_cast<std::size_t>(place[node]);
        };
        double block[9];
        // A block of the row of this node, by columns, is the one of its column, by rows.
        for (int e = matrix.left_start[use.node]; e < matrix.left_start[use.node + 1]; ++e) {
            const std::size_t at = 9 * static_cast<std::size_t>(matrix.left_pair[e]);
            for (std::size_t b = 0; b < 9; ++b)
                block[b] = static_cast<double>(matrix.value[at + b]) + static_cast<double>(matrix.rest[at + b]);
            add_block(block, rows, force_on(matrix.left_column[e]));
        }
        for (int k = matrix.start[use.node]; k < matrix.start[use.node + 1]; ++k) {
            const std::size_t at = 9 * static_cast<std::size_t>(k);
            for (std::size_t c = 0; c < 3; ++c) {
                for (std::size_t r = 0; r < 3; ++r)
                    block[3 * r + c] = static_cast<double>(matrix.value[at + 3 * c + r]) +
                                       static_cast<double>(matrix.rest[at + 3 * c + r]);
            }
            add_block(block, rows, force_on(matrix.row[k]));
        }
    }
}

void products_with_groups(const GroupMotions& motions, std::span<const int> nodes, const double* forces, int first,
                          const int* place, double* sums) {
    for (std::size_t at = 0; at < nodes.size(); ++at) {
        const double* force = forces + 3 * modes_stored * at;
        const Row rows[3] = {Row::load(force), Row::load(force + modes_stored), Row::load(force + 2 * modes_stored)};
        for (int e = motions.start[nodes[at]]; e < motions.start[nodes[at] + 1]; ++e) {
            if (motions.group[e] < first) continue;
            const float* motion = motions.motion + 3 * GroupMotions::modes * static_cast<std::size_t>(e);
            double factors[3 * GroupMotions::modes];  // by rows of the transposed motion
            for (std::size_t f = 0; f < 3 * GroupMotions::modes; ++f) factors[f] = static_cast<double>(motion[f]);
            double* sum = sums + GroupMotions::modes * modes_stored * static_cast<std::size_t>(place[motions.group[e]]);
            add_block(factors, rows, sum);
            add_block(factors + 9, rows, sum + 3 * modes_stored);
        }
    }
}

}  // namespace pliant::linalg::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pliant::linalg {

HWY_EXPORT(forces_of_group);
HWY_EXPORT(products_with_groups);

void add_forces_of_group(const LowerTriangle& matrix, const GroupMotions& motions, std::span<const MotionUse> uses,
                         const int* place, double* forces) {
    HWY_DYNAMIC_DISPATCH(forces_of_group)(matrix, motions, uses, place, forces);
}

void add_products_with_groups(const GroupMotions& motions, std::span<const int> nodes, const double* forces, int first,
                              const int* place, double* sums) {
    HWY_DYNAMIC_DISPATCH(products_with_groups)(motions, nodes, forces, first, place, sums);
}

}  // namespace pliant::linalg
#endif
