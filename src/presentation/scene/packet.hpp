// Binary packets for the page: a JSON head followed by arrays of numbers, which a browser can view without copying.
// Little-endian throughout:
//
//     bytes 0-3    "PLN1"
//     bytes 4-7    length of the head, a multiple of 4
//     head         JSON, {"head": ..., "arrays": [{"name": "positions", "type": "f32", "count": 300}, ...]}, blanks
//     arrays       one after the other, 4 bytes a number
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pliant::view {

class Packet {
public:
    /// Names are plain: letters, digits and '_'.
    void add(std::string_view name, const std::vector<float>& values);
    void add(std::string_view name, const std::vector<std::uint32_t>& values);
    /// `head`: any JSON.
    [[nodiscard]] std::string finish(std::string_view head) const;

private:
    void list(std::string_view name, std::string_view type, std::size_t count);
    std::string arrays_;  ///< JSON, without brackets
    std::string bytes_;
};

}  // namespace pliant::view
