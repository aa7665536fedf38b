#include "printing/slice/compose.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace pliant::slice {
namespace {

struct Share {
    int body;
    std::int64_t winding;  ///< signed coverage, in steps
};

struct Owner {
    int material = -1;
    std::uint8_t value = 0;
};

struct Pixel {
    int row, column;
};

std::int64_t covered(std::int64_t winding) {
    return std::min(full_coverage, std::abs(winding));
}

/// Converts coverage to grey values.
class Greys {
public:
    explicit Greys(const ComposeRules& rules)
        : anti_alias_(rules.anti_alias),
          threshold_(std::max<std::int64_t>(
              1, static_cast<std::int64_t>(std::ceil(rules.threshold * static_cast<double>(full_coverage) - 0.5)))) {}

    [[nodiscard]] std::uint8_t operator()(std::int64_t coverage) const {
        if (!anti_alias_) return coverage >= threshold_ ? 255 : 0;
        return static_cast<std::uint8_t>((255 * coverage + full_coverage / 2) >> coverage_bits);
    }

private:
    bool anti_alias_;
    std::int64_t threshold_;
};

/// The images of all materials of a layer.
class Canvas {
public:
    Canvas(const Raster& raster, std::size_t materials)
        : width_px_(raster.width_px), images_(materials, RunImage(raster.width_px, raster.height_px)) {}

    void run(const Owner& owner, int row, int begin, int end) {
        end = std::min(end, width_px_);
        if (owner.value == 0 || begin >= end) return;
        images_[owner.material].append(row, begin, end, owner.value);
    }

    /// The material and value of a pixel; material -1 if it is dark or outside.
    [[nodiscard]] std::pair<int, int> look(Pixel p) const {
        for (std::size_t m = 0; m < images_.size(); ++m) {
            if (const int value = images_[m].at(p.row, p.column); value > 0) return {static_cast<int>(m), value};
        }
        return {-1, 0};
    }

    [[nodiscard]] bool mixed() const {
        return std::count_if(images_.begin(), images_.end(), [](const RunImage& i) { return !i.blank(); }) > 1;
    }

    /// Sets pixels, ordered by row and column, to full light.
    void brighten(const std::vector<Pixel>& pixels) {
        std::vector<std::vector<Pixel>> of_material(images_.size());
        for (const Pixel& p : pixels) of_material[look(p).first].push_back(p);
        for (std::size_t m = 0; m < images_.size(); ++m) {
            if (!of_material[m].empty()) images_[m] = brightened(images_[m], of_material[m]);
        }
    }

    std::vector<MaterialImage> take() { return lit_images(std::move(images_)); }

private:
    static RunImage brightened(const RunImage& image, const std::vector<Pixel>& pixels) {
        RunImage result(image.width_px(), image.height_px());
        auto next = pixels.begin();
        for (int row = image.first_row(); row < image.end_row(); ++row) {
            for (const Run& run : image.row(row)) {
                int begin = run.begin;
                for (; next != pixels.end() && next->row == row && next->column < run.end; ++next) {
                    if (begin < next->column) result.append(row, begin, next->column, run.value);
                    result.append(row, next->column, next->column + 1, 255);
                    begin = next->column + 1;
                }
                if (begin < run.end) result.append(row, begin, run.end, run.value);
            }
        }
        return result;
    }

    int width_px_;
    std::vector<RunImage> images_;
};

/// Overlap in a pixel up to which bodies count as only touching.
constexpr std::int64_t touching = full_coverage >> 16;

class Composer {
public:
    Composer(std::span<const int> material_of, const Raster& raster, const ComposeRules& rules)
        : material_of_(material_of),
          material_count_(material_of.empty() ? 0 : *std::max_element(material_of.begin(), material_of.end()) + 1),
          width_px_(raster.width_px),
          grey_(rules),
          share_of_(material_count_),
          canvas_(raster, material_count_) {
        layer_.lost_px.assign(material_of.size(), 0.0);
        layer_.doubled_px.assign(material_of.size(), 0.0);
        const double missing = rules.anti_alias ? std::min(0.5, rules.close_gap_um / raster.pixel_um) : 0.0;
        least_gap_value_ = static_cast<int>(std::ceil(255 * (1 - missing) - 1e-9));
    }

    ComposedLayer compose(const std::vector<Cell>& cells) {
        const bool alone = !cells.empty() && std::all_of(cells.begin(), cells.end(), [&](const Cell& c) {
            return c.body() == cells.front().body();
        });
        for (std::size_t i = 0; i < cells.size();) {
            std::size_t end = i;
            while (end < cells.size() && cells[end].row() == cells[i].row()) ++end;
            const std::span row(cells.data() + i, end - i);
            if (alone) {
                sweep_row_of_one(row);
            } else {
                sweep_row(row);
            }
            i = end;
        }
        close_gaps();
        layer_.images = canvas_.take();
        return std::move(layer_);
    }

private:
    /// A layer of one body needs no ownership test and has no gaps.
    void sweep_row_of_one(std::span<const Cell> cells) {
        const int material = material_of_[cells[0].body()], row = cells[0].row();
        std::int64_t winding = 0;
        int cursor = 0;
        for (std::size_t i = 0; i < cells.size();) {
            const int column = cells[i].column();
            if (winding != 0) canvas_.run({material, grey_(counted(winding))}, row, cursor, column);
            std::int64_t here = winding;
            for (; i < cells.size() && cells[i].column() == column; ++i) {
                here += cells[i].area;
                winding += cells[i].cover;
            }
            canvas_.run({material, grey_(counted(here))}, row, column, column + 1);
            cursor = column + 1;
        }
    }

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
        // With closed outlines nothing is active at the end of a row.
    }

    /// Sets `here_` to the windings inside the pixel of these cells and `active_` to those to its right.
    void enter(std::span<const Cell> cells) {
        here_ = active_;
        for (const Cell& cell : cells) {
            at(here_, cell.body()).winding += cell.area;
            at(active_, cell.body()).winding += cell.cover;
        }
        std::erase_if(active_, [](const Share& s) { return s.winding == 0; });
    }

    static Share& at(std::vector<Share>& shares, int body) {
        const auto place =
            std::lower_bound(shares.begin(), shares.end(), body, [](const Share& s, int b) { return s.body < b; });
        if (place != shares.end() && place->body == body) return *place;
        return *shares.insert(place, Share{body, 0});
    }

    void paint(const std::vector<Share>& shares, int row, int begin, int end) {
        end = std::min(end, width_px_);
        if (shares.empty() || begin >= end) return;
        const Owner owner = resolve(shares);
        canvas_.run(owner, row, begin, end);
        if (owner.value >= least_gap_value_ && owner.value < 255) {
            for (int column = begin; column < end; ++column) nearly_full_.push_back({row, column});
        }
    }

    std::int64_t counted(std::int64_t winding) {
        layer_.overlapping = layer_.overlapping || std::abs(winding) > full_coverage + touching;
        return covered(winding);
    }

    /// Allocates the pixel to the bodies from the last to the first until it is full.
    Owner resolve(const std::vector<Share>& shares) {
        std::int64_t used = 0;
        int winner = -1;
        served_.clear();
        for (std::size_t i = shares.size(); i-- > 0;) {
            const std::int64_t wanted = counted(shares[i].winding);
            if (wanted == 0) continue;
            const int material = material_of_[shares[i].body];
            if (std::find(served_.begin(), served_.end(), material) == served_.end()) {
                served_.push_back(material);
                share_of_[material] = 0;
            }
            const std::int64_t got = std::min(wanted, full_coverage - used);
            layer_.overlapping = layer_.overlapping || wanted - got > touching;
            share_of_[material] += got;
            used += got;
        }
        for (const int material : served_) {
            if (winner < 0 || share_of_[material] > share_of_[winner]) winner = material;
        }
        return {winner, grey_(used)};
    }

    void close_gaps() {
        if (nearly_full_.empty() || !canvas_.mixed()) return;
        const auto between = [&](Pixel p, int down, int right) {
            const auto [m0, v0] = canvas_.look({p.row - down, p.column - right});
            const auto [m1, v1] = canvas_.look({p.row + down, p.column + right});
            return m0 >= 0 && m1 >= 0 && m0 != m1 && std::max(v0, v1) == 255 && std::min(v0, v1) >= least_gap_value_;
        };
        std::erase_if(nearly_full_, [&](Pixel p) { return !between(p, 0, 1) && !between(p, 1, 0); });
        canvas_.brighten(nearly_full_);
        layer_.closed_gap_pixels = static_cast<std::int64_t>(nearly_full_.size());
    }

    std::span<const int> material_of_;
    std::size_t material_count_;
    int width_px_;
    Greys grey_;
    std::vector<std::int64_t> share_of_;  ///< per material, of the pixel being resolved
    std::vector<int> served_;             ///< the materials with a valid entry in share_of_, latest body first
    std::vector<Share> active_, here_;
    std::vector<Pixel> nearly_full_;
    int least_gap_value_ = 255;
    Canvas canvas_;
    ComposedLayer layer_;
};

template <class Images>
auto* find_image(Images& images, int material) {
    const auto found =
        std::find_if(images.begin(), images.end(), [&](const MaterialImage& m) { return m.material == material; });
    return found == images.end() ? nullptr : &*found;
}

}  // namespace

std::vector<MaterialImage> lit_images(std::vector<RunImage> images) {
    std::vector<MaterialImage> lit;
    for (std::size_t m = 0; m < images.size(); ++m) {
        if (images[m].blank()) continue;
        const std::int64_t sum = images[m].value_sum();
        lit.push_back({static_cast<int>(m), std::move(images[m]), sum, 0});
    }
    return lit;
}

const MaterialImage* find(const ComposedLayer& layer, int material) {
    return find_image(layer.images, material);
}

MaterialImage* find(ComposedLayer& layer, int material) {
    return find_image(layer.images, material);
}

ComposedLayer compose(const std::vector<Cell>& cells, std::span<const int> material_of, const Raster& raster,
                      const ComposeRules& rules) {
    return Composer(material_of, raster, rules).compose(cells);
}

}  // namespace pliant::slice
