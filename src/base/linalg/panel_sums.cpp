// Adds updates of children to panels and updates.
// Compiled once for each instruction set; the best one available is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/linalg/panel_sums.cpp"
#include <hwy/foreach_target.h>

#include "base/linalg/panel.hpp"
// Must follow foreach_target.
#include <hwy/highway.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "base/core/parallel.hpp"

HWY_BEFORE_NAMESPACE();
namespace pliant::linalg::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Minimum numbers of an update to add for using another core.
constexpr std::size_t additions_to_share = 50000;

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

}  // namespace pliant::linalg::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pliant::linalg {

HWY_EXPORT(add_to_panel_double);
HWY_EXPORT(add_to_panel_float);
HWY_EXPORT(add_to_update_double);
HWY_EXPORT(add_to_update_float);

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

}  // namespace pliant::linalg
#endif
