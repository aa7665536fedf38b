#include "printing/slice/compensate.hpp"

#include <algorithm>
#include <climits>
#include <cmath>
#include <tuple>
#include <utility>

#include "printing/slice/run_set.hpp"

namespace pliant::slice {
namespace {

/// Fine pixels of `place` in a gap of at most `width` between a and b, along their row or column.
RunSet gap_between(const RunSet& a, const RunSet& b, const RunSet& place, int width) {
    const auto between = [&](const Reach& to_a, const Reach& to_b) {
        return common(common(reaching(a, to_a), reaching(b, to_b)), place);
    };
    const Reach left{width, 0, 0, 0}, right{0, width, 0, 0}, up{0, 0, width, 0}, down{0, 0, 0, width};
    return united(united(between(left, right), between(right, left)), united(between(up, down), between(down, up)));
}

/// The materials of a layer as sets of fine pixels.
class FineLayer {
public:
    FineLayer(const ComposedLayer& fine, std::size_t materials, const Raster& raster)
        : sets_(materials, RunSet(raster.width_px, raster.height_px)), free_(raster.width_px, raster.height_px) {
        RunSet solid(raster.width_px, raster.height_px);
        for (const MaterialImage& m : fine.images) {
            sets_[static_cast<std::size_t>(m.material)] = RunSet::lit(m.image);
            solid = united(solid, sets_[static_cast<std::size_t>(m.material)]);
        }
        free_ = complement(solid);
    }

    /// Returns the number of fine pixels filled.
    std::int64_t close_gaps(int width) {
        std::int64_t closed = 0;
        for (std::size_t a = 0; a < sets_.size() && width > 0; ++a) {
            for (std::size_t b = a + 1; b < sets_.size(); ++b) {
                if (sets_[a].empty() || sets_[b].empty()) continue;
                const RunSet gap = gap_between(sets_[a], sets_[b], free_, width);
                closed += gap.pixels();
                take(a, gap);
            }
        }
        return closed;
    }

    void offset(std::span<const int> by) {
        const RunSet outside = free_;
        for (std::size_t m = sets_.size(); m-- > 0;) {
            if (by[m] < 0) sets_[m] = without(sets_[m], grown(outside, -by[m]));
            if (by[m] > 0) take(m, common(grown(sets_[m], by[m]), free_));
        }
    }

    [[nodiscard]] const std::vector<RunSet>& sets() const { return sets_; }

private:
    void take(std::size_t material, const RunSet& pixels) {
        sets_[material] = united(sets_[material], pixels);
        free_ = without(free_, pixels);
    }

    std::vector<RunSet> sets_;
    RunSet free_;
};

/// Converts fine pixels to pixels.
class Reducer {
public:
    Reducer(const std::vector<RunSet>& sets, int factor, const Raster& raster, const ComposeRules& rules)
        : sets_(sets), factor_(factor), rules_(rules), width_px_(raster.width_px), counts_(sets.size()) {
        for (std::size_t m = 0; m < sets.size(); ++m) images_.emplace_back(raster.width_px, raster.height_px);
        for (auto& row : counts_) row.assign(static_cast<std::size_t>(width_px_), 0);
    }

    std::vector<MaterialImage> images() {
        int first = INT_MAX, end = 0;
        for (const RunSet& set : sets_) {
            if (set.first_row() == set.end_row()) continue;
            first = std::min(first, set.first_row() / factor_);
            end = std::max(end, (set.end_row() + factor_ - 1) / factor_);
        }
        for (int row = first; row < end; ++row) add_row(row);
        return lit_images(std::move(images_));
    }

private:
    void add_row(int row) {
        for (std::size_t m = 0; m < sets_.size(); ++m) {
            std::fill(counts_[m].begin(), counts_[m].end(), 0);
            for (int fine = row * factor_; fine < (row + 1) * factor_; ++fine) {
                for (const PixelSpan& span : sets_[m].row(fine)) count(span, counts_[m]);
            }
        }
        for (int column = 0; column < width_px_; ++column) {
            int most = 0, sum = 0, owner = 0;
            for (std::size_t m = 0; m < counts_.size(); ++m) {
                const int here = counts_[m][static_cast<std::size_t>(column)];
                sum += here;
                if (here > 0 && here >= most) std::tie(most, owner) = std::pair(here, static_cast<int>(m));
            }
            if (sum > 0) images_[static_cast<std::size_t>(owner)].append(row, column, column + 1, grey(sum));
        }
    }

    void count(const PixelSpan& span, std::vector<int>& counts) const {
        for (int at = span.begin; at < span.end;) {
            const int column = at / factor_, next = std::min(span.end, (column + 1) * factor_);
            counts[static_cast<std::size_t>(column)] += next - at;
            at = next;
        }
    }

    [[nodiscard]] std::uint8_t grey(int fine_pixels) const {
        const int all = factor_ * factor_;
        if (!rules_.anti_alias) return fine_pixels >= rules_.threshold * all ? 255 : 0;
        return static_cast<std::uint8_t>((255 * fine_pixels + all / 2) / all);
    }

    const std::vector<RunSet>& sets_;
    int factor_;
    const ComposeRules& rules_;
    int width_px_;
    std::vector<std::vector<int>> counts_;  ///< per material and column: number of fine pixels in the row being summed
    std::vector<RunImage> images_;
};

}  // namespace

double Compensation::offset_um(int layer) const {
    if (layer >= foot_layers) return grow_um;
    return grow_um - foot_um * (foot_layers - layer) / foot_layers;
}

double growth_um(const Compensation& compensation, int layers) {
    return layers < 1 ? 0 : std::max(0.0, compensation.offset_um(layers - 1));
}

std::string grown_label(const std::string& label, double growth_um) {
    return growth_um > 0 ? fmt::format("{}, grown by its xy_compensation of {:g} mm", label, growth_um / 1000) : label;
}

Status check(const Compensation& c, const std::string& where) {
    constexpr double most_um = 10000;
    if (!(std::fabs(c.grow_um) <= most_um))
        return input_error("{}: XY compensation of {:.6g} um: must be -10000 to 10000 um", where, c.grow_um);
    if (!(c.foot_um >= 0 && c.foot_um <= most_um))
        return input_error("{}: elephant foot of {:.6g} um: must be 0 to 10000 um", where, c.foot_um);
    if (!(c.bleed_um >= 0 && c.bleed_um <= most_um))
        return input_error("{}: bleed compensation of {:.6g} um: must be 0 to 10000 um", where, c.bleed_um);
    if (c.foot_layers < 0 || c.foot_layers > 10000)
        return input_error("{}: elephant foot in {} layers: must be 0 to 10000", where, c.foot_layers);
    return {};
}

int fine_factor(const Raster& raster) {
    int factor = 16;
    while (factor > 1 && std::max(raster.width_px, raster.height_px) > 65535 / factor) factor /= 2;
    return factor;
}

Raster refined(const Raster& raster, int factor) {
    Raster fine = raster;
    fine.width_px *= factor;
    fine.height_px *= factor;
    fine.pixel_um /= factor;
    return fine;
}

ComposedLayer compensated(const ComposedLayer& fine, int factor, std::span<const double> offset_um,
                          const Raster& raster, const ComposeRules& rules) {
    const Raster fine_raster = refined(raster, factor);
    FineLayer layer(fine, offset_um.size(), fine_raster);
    const double most_gap_um = rules.anti_alias ? std::min(rules.close_gap_um, raster.pixel_um / 2) : 0.0;
    const std::int64_t closed = layer.close_gaps(static_cast<int>(std::ceil(most_gap_um / fine_raster.pixel_um)));
    std::vector<int> by;
    for (const double um : offset_um) by.push_back(static_cast<int>(std::lround(um / fine_raster.pixel_um)));
    layer.offset(by);
    const int fine_per_pixel = factor * factor;
    ComposedLayer result{Reducer(layer.sets(), factor, raster, rules).images(), fine.lost_px,
                         (closed + fine_per_pixel - 1) / fine_per_pixel, fine.overlapping, fine.doubled_px};
    for (double& lost : result.lost_px) lost /= fine_per_pixel;
    for (double& doubled : result.doubled_px) doubled /= fine_per_pixel;
    result.air_px = fine.air_px;
    for (double& air : result.air_px) air /= fine_per_pixel;
    return result;
}

}  // namespace pliant::slice
