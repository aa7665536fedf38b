#include "printing/slice/light.hpp"

#include <algorithm>
#include <cmath>

namespace pliant::slice {

std::array<std::uint8_t, 256> grey_values(std::span<const double> light) {
    std::array<std::uint8_t, 256> values{};
    const auto last = static_cast<double>(light.size() - 1);
    for (std::size_t v = 1; v < values.size(); ++v) {
        const double at = static_cast<double>(v) / 255 * last;
        const std::size_t i = std::min(static_cast<std::size_t>(at), light.size() - 2);
        const double share = at - static_cast<double>(i);
        const double between = light[i] + (light[i + 1] - light[i]) * share;
        values[v] = static_cast<std::uint8_t>(std::lround(255 * std::clamp(between, 0.0, 1.0)));
    }
    return values;
}

RunImage corrected(const RunImage& image, const LightCorrection& correction) {
    RunImage result(image.width_px(), image.height_px());
    for (int row = image.first_row(); row < image.end_row(); ++row) {
        for (const Run& run : image.row(row)) {
            const std::uint8_t value = correction.grey ? (*correction.grey)[run.value] : run.value;
            if (!correction.mask) {
                result.append(row, run.begin, run.end, value);
                continue;
            }
            for (int column = run.begin; column < run.end; ++column) {
                const int masked = (value * correction.mask->at(row, column) + 127) / 255;
                result.append(row, column, column + 1, static_cast<std::uint8_t>(masked));
            }
        }
    }
    return result;
}

std::int64_t darkened_sum(const RunImage& image, const LightCorrection& correction) {
    if (!correction.mask) return 0;
    std::int64_t sum = 0;
    for (int row = image.first_row(); row < image.end_row(); ++row) {
        for (const Run& run : image.row(row)) {
            for (int column = run.begin; column < run.end; ++column) {
                if (correction.mask->at(row, column) == 0) sum += run.value;
            }
        }
    }
    return sum;
}

}  // namespace pliant::slice
