// A grey image as a DLP projector shows it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pliant::slice {

/// 8-bit grey, row by row from the top; 0 is dark, 255 full light.
struct Image {
    int width_px = 0;
    int height_px = 0;
    std::vector<std::uint8_t> pixels;  ///< (height_px, width_px)

    [[nodiscard]] std::uint8_t at(int row, int column) const {
        return pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_px) +
                      static_cast<std::size_t>(column)];
    }
    bool operator==(const Image&) const = default;
};

}  // namespace pliant::slice
