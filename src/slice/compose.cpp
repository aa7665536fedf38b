#include "slice/compose.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pliant::slice {
namespace {

/// Coverage is kept in steps of 2^-36: coarser than the rounding of sums along a row, far finer than a grey value, so
/// that an exact tie is a tie and what has left a row has left it.
double quantised(double coverage) {
    constexpr double steps = 68719476736.0;
    return std::nearbyint(coverage * steps) / steps;
}

struct Share {
    int body;
    double winding;  ///< signed coverage
};

struct Owner {
    int material = -1;
    std::uint8_t value = 0;
};

/// Paints into images that are made when they are first needed.
class Canvas {
public:
    Canvas(const Raster& raster, std::size_t materials) : raster_(raster), images_(materials) {}

    void run(const Owner& owner, int row, int begin, int end) {
        end = std::min(end, raster_.width_px);
        if (owner.value == 0 || begin >= end) return;
        auto& pixels = image(owner.material).pixels;
        const auto at = pixels.begin() + index(row, begin);
        std::fill(at, at + (end - begin), owner.value);
        sums_[owner.material] += std::int64_t{owner.value} * (end - begin);
    }

    /// The material and value of a pixel; material -1 where it is dark or outside.
    [[nodiscard]] std::pair<int, int> look(int row, int column) const {
        if (row < 0 || column < 0 || row >= raster_.height_px || column >= raster_.width_px) return {-1, 0};
        for (std::size_t m = 0; m < images_.size(); ++m) {
            if (images_[m].pixels.empty()) continue;
            if (const int value = images_[m].at(row, column); value > 0) return {static_cast<int>(m), value};
        }
        return {-1, 0};
    }

    void brighten(int row, int column) {
        const auto [material, value] = look(row, column);
        images_[material].pixels[index(row, column)] = 255;
        sums_[material] += 255 - value;
    }

    std::vector<MaterialImage> take() {
        std::vector<MaterialImage> taken;
        for (std::size_t m = 0; m < images_.size(); ++m) {
            if (!images_[m].pixels.empty()) taken.push_back({static_cast<int>(m), std::move(images_[m]), sums_[m]});
        }
        return taken;
    }

private:
    [[nodiscard]] std::size_t index(int row, int column) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(raster_.width_px) +
               static_cast<std::size_t>(column);
    }
    Image& image(int material) {
        Image& image = images_[material];
        if (image.pixels.empty()) {
            image.width_px = raster_.width_px;
            image.height_px = raster_.height_px;
            image.pixels.resize(static_cast<std::size_t>(raster_.width_px) *
                                static_cast<std::size_t>(raster_.height_px));
        }
        return image;
    }

    const Raster& raster_;
    std::vector<Image> images_;
    std::vector<std::int64_t> sums_ = std::vector<std::int64_t>(images_.size(), 0);
};

class Composer {
public:
    Composer(std::span<const int> material_of, const Raster& raster, const ComposeRules& rules)
        : material_of_(material_of),
          raster_(raster),
          rules_(rules),
          material_count_(material_of.empty() ? 0 : *std::max_element(material_of.begin(), material_of.end()) + 1),
          share_of_(material_count_),
          canvas_(raster, material_count_) {
        layer_.lost_px.assign(material_of.size(), 0.0);
        const double missing = rules.anti_alias ? std::min(0.5, rules.close_gap_um / raster.pixel_um) : 0.0;
        least_gap_value_ = static_cast<int>(std::ceil(255 * (1 - missing) - 1e-9));
    }

    ComposedLayer compose(const std::vector<Cell>& cells) {
        for (std::size_t i = 0; i < cells.size();) {
            std::size_t end = i;
            while (end < cells.size() && cells[end].row() == cells[i].row()) ++end;
            sweep_row(std::span(cells).subspan(i, end - i));
            i = end;
        }
        close_gaps();
        layer_.images = canvas_.take();
        return std::move(layer_);
    }

private:
    void sweep_row(std::span<const Cell> cells) {
        active_.clear();
        int cursor = 0;
        for (std::size_t i = 0; i < cells.size();) {
            const int column = cells[i].column(), row = cells[i].row();
            std::size_t end = i;
            while (end < cells.size() && cells[end].column() == column) ++end;
            paint(active_, row, cursor, column);
            enter(cells.subspan(i, end - i));
            paint(here_, row, column, column + 1);
            cursor = column + 1;
            i = end;
        }
        // A closed outline leaves nothing active at the end of a row.
    }

    /// Sets `here_` to the windings inside the pixel of these cells and `active_` to those to its right.
    void enter(std::span<const Cell> cells) {
        here_ = active_;
        for (const Cell& cell : cells) {
            at(here_, cell.body()).winding += cell.area;
            at(active_, cell.body()).winding += cell.cover;
        }
        std::erase_if(active_, [](const Share& s) { return quantised(s.winding) == 0; });
    }

    static Share& at(std::vector<Share>& shares, int body) {
        const auto place =
            std::lower_bound(shares.begin(), shares.end(), body, [](const Share& s, int b) { return s.body < b; });
        if (place != shares.end() && place->body == body) return *place;
        return *shares.insert(place, Share{body, 0});
    }

    void paint(const std::vector<Share>& shares, int row, int begin, int end) {
        if (shares.empty() || begin >= end) return;
        const Owner owner = resolve(shares, std::min(end, raster_.width_px) - begin);
        canvas_.run(owner, row, begin, end);
        if (owner.value >= least_gap_value_ && owner.value < 255) {
            for (int column = begin; column < std::min(end, raster_.width_px); ++column)
                nearly_full_.emplace_back(row, column);
        }
    }

    /// Serves the bodies from the last to the first until the pixel is full.
    Owner resolve(const std::vector<Share>& shares, int pixels) {
        double used = 0;
        int winner = -1;
        served_.clear();
        for (std::size_t i = shares.size(); i-- > 0;) {
            const double wanted = std::min(1.0, std::fabs(quantised(shares[i].winding)));
            if (wanted == 0) continue;
            const int material = material_of_[shares[i].body];
            if (std::find(served_.begin(), served_.end(), material) == served_.end()) {
                served_.push_back(material);
                share_of_[material] = 0;
            }
            const double got = std::min(wanted, 1 - used);
            const double taken_by_others = std::min(wanted - got, used - share_of_[material]);
            if (taken_by_others > 0) layer_.lost_px[shares[i].body] += taken_by_others * pixels;
            share_of_[material] += got;
            used += got;
        }
        for (const int material : served_) {
            if (winner < 0 || share_of_[material] > share_of_[winner]) winner = material;
        }
        return {winner, value_of(used)};
    }

    [[nodiscard]] std::uint8_t value_of(double coverage) const {
        if (!rules_.anti_alias) return coverage > 0 && coverage >= rules_.threshold ? 255 : 0;
        return static_cast<std::uint8_t>(std::lround(255 * std::min(1.0, coverage)));
    }

    void close_gaps() {
        const auto between = [&](int row, int column, int down, int right) {
            const auto [m0, v0] = canvas_.look(row - down, column - right);
            const auto [m1, v1] = canvas_.look(row + down, column + right);
            return m0 >= 0 && m1 >= 0 && m0 != m1 && std::max(v0, v1) == 255 && std::min(v0, v1) >= least_gap_value_;
        };
        std::erase_if(nearly_full_, [&](const auto& p) {
            return !between(p.first, p.second, 0, 1) && !between(p.first, p.second, 1, 0);
        });
        for (const auto& [row, column] : nearly_full_) canvas_.brighten(row, column);
        layer_.closed_gap_pixels = static_cast<std::int64_t>(nearly_full_.size());
    }

    std::span<const int> material_of_;
    const Raster& raster_;
    const ComposeRules& rules_;
    std::size_t material_count_;
    std::vector<double> share_of_;  ///< per material, of the pixel being resolved
    std::vector<int> served_;       ///< the materials that share_of_ is valid for, latest body first
    std::vector<Share> active_, here_;
    std::vector<std::pair<int, int>> nearly_full_;
    int least_gap_value_ = 255;
    Canvas canvas_;
    ComposedLayer layer_;
};

}  // namespace

ComposedLayer compose(const std::vector<Cell>& cells, std::span<const int> material_of, const Raster& raster,
                      const ComposeRules& rules) {
    return Composer(material_of, raster, rules).compose(cells);
}

}  // namespace pliant::slice
