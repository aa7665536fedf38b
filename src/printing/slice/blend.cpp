#include "printing/slice/blend.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/core/share.hpp"
#include "printing/slice/raster_frame.hpp"

namespace pliant::slice {
namespace {

/// A reproducible pseudo-random number in [0, 1).
double hash(int layer, int row, int column) {
    auto h = static_cast<std::uint64_t>(layer) * 0x9E3779B97F4A7C15ULL;
    h ^= (static_cast<std::uint64_t>(row) << 32) + static_cast<std::uint64_t>(column) + 0x7F4A7C15U + (h << 6);
    h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9ULL;
    h = (h ^ (h >> 27)) * 0x94D049BB133111EBULL;
    return static_cast<double>((h ^ (h >> 31)) >> 11) * 0x1p-53;
}

/// Decides which cells of an image the second material gets.
class Dealer {
public:
    Dealer(const RunImage& image, const Blend& blend, const Raster& raster, double z_um, int layer)
        : image_(image),
          blend_(blend),
          frame_(raster, 1),
          z_um_(z_um),
          layer_(layer),
          columns_((raster.width_px + blend.cell_px - 1) / blend.cell_px) {
        for (auto* row : {&light_, &next_light_}) row->resize(static_cast<std::size_t>(columns_));
        for (auto* row : {&error_, &next_error_}) row->resize(static_cast<std::size_t>(columns_));
        second_.resize(static_cast<std::size_t>(columns_));
    }

    std::pair<RunImage, RunImage> deal() {
        std::pair<RunImage, RunImage> dealt{RunImage(image_.width_px(), image_.height_px()),
                                            RunImage(image_.width_px(), image_.height_px())};
        const int n = blend_.cell_px;
        weigh(image_.first_row() / n, next_light_);
        for (int row = image_.first_row() / n; row * n < image_.end_row(); ++row) {
            std::swap(light_, next_light_);
            weigh(row + 1, next_light_);
            std::swap(error_, next_error_);
            std::fill(next_error_.begin(), next_error_.end(), 0.0);
            decide(row);
            for (int r = row * n; r < std::min((row + 1) * n, image_.end_row()); ++r) copy_row(r, dealt);
        }
        return dealt;
    }

private:
    void weigh(int row, std::vector<double>& light) const {
        std::fill(light.begin(), light.end(), 0.0);
        const int n = blend_.cell_px;
        for (int r = row * n; r < (row + 1) * n; ++r) {
            for (const Run& run : image_.row(r)) {
                for (int at = run.begin; at < run.end;) {
                    const int cell = at / n, end = std::min<int>(run.end, (cell + 1) * n);
                    light[static_cast<std::size_t>(cell)] += static_cast<double>(run.value * (end - at));
                    at = end;
                }
            }
        }
    }

    void decide(int row) {
        const bool back = (row + layer_) % 2 != 0;
        for (int i = 0; i < columns_; ++i) {
            const int column = back ? columns_ - 1 - i : i;
            const auto c = static_cast<std::size_t>(column);
            if (light_[c] == 0) continue;
            const double wanted = light_[c] * share(row, column) + error_[c] + rest_;
            const double threshold = light_[c] * (0.3 + 0.4 * hash(layer_, row, column));
            second_[c] = wanted >= threshold;
            rest_ = 0;
            pass_on(wanted - (second_[c] ? light_[c] : 0), column, back ? -1 : 1);
        }
    }

    [[nodiscard]] double share(int row, int column) const {
        const double half = blend_.cell_px / 2.0;
        const auto [x, y] = frame_.place(column * blend_.cell_px + half, row * blend_.cell_px + half);
        return share_at(blend_, {x, y, z_um_});
    }

    void pass_on(double error, int column, int ahead) {
        struct Neighbour {
            double* error;
            double weight;
        };
        std::array<Neighbour, 4> found{};
        std::size_t count = 0;
        double weights = 0;
        const auto offer = [&](const std::vector<double>& light, std::vector<double>& errors, int c, double weight) {
            if (c < 0 || c >= columns_ || light[static_cast<std::size_t>(c)] == 0) return;
            found[count++] = {&errors[static_cast<std::size_t>(c)], weight};
            weights += weight;
        };
        offer(light_, error_, column + ahead, 7);
        offer(next_light_, next_error_, column - ahead, 3);
        offer(next_light_, next_error_, column, 5);
        offer(next_light_, next_error_, column + ahead, 1);
        if (count == 0) rest_ = error;
        for (std::size_t i = 0; i < count; ++i) *found[i].error += error * found[i].weight / weights;
    }

    void copy_row(int row, std::pair<RunImage, RunImage>& dealt) const {
        const int n = blend_.cell_px;
        for (const Run& run : image_.row(row)) {
            for (int at = run.begin; at < run.end;) {
                const int cell = at / n, end = std::min<int>(run.end, (cell + 1) * n);
                (second_[static_cast<std::size_t>(cell)] ? dealt.second : dealt.first).append(row, at, end, run.value);
                at = end;
            }
        }
    }

    const RunImage& image_;
    const Blend& blend_;
    RasterFrame frame_;
    double z_um_;
    int layer_, columns_;
    std::vector<double> light_, next_light_, error_, next_error_;  ///< of the current row of cells, and of the next one
    std::vector<bool> second_;
    double rest_ = 0;  ///< accumulated error that no neighbour took
};

}  // namespace

Status check(const Blend& blend, const std::string& where) {
    if (blend.second.empty()) return input_error("{}: its blend names no second material", where);
    const Vec3 way = blend.to_um - blend.from_um;
    if (!(dot(way, way) > 0)) return input_error("{}: its blend begins and ends at the same place", where);
    if (blend.shares.size() < 2) return input_error("{}: its blend needs two shares or more", where);
    for (const double share : blend.shares) {
        if (!(share >= 0 && share <= 1)) return input_error("{}: share {} of its blend: must be 0 to 1", where, share);
    }
    if (blend.cell_px < 1 || blend.cell_px > 1000)
        return input_error("{}: cells of {} pixels in its blend: must be 1 to 1000", where, blend.cell_px);
    return {};
}

double share_at(const Blend& blend, const Vec3& place_um) {
    return share_along(blend.shares, blend.from_um, blend.to_um, place_um);
}

std::pair<RunImage, RunImage> dealt(const RunImage& image, const Blend& blend, const Raster& raster, double z_um,
                                    int layer) {
    return Dealer(image, blend, raster, z_um, layer).deal();
}

}  // namespace pliant::slice
