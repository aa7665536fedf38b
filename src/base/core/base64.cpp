#include "base/core/base64.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace pliant {
namespace {

constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

constexpr int blank = -1;
constexpr int padding = -2;
constexpr int foreign = -3;

/// What each character stands for.
constexpr std::array<int, 256> values = [] {
    std::array<int, 256> table{};
    table.fill(foreign);
    const auto at = [&](char c) -> int& { return table[static_cast<unsigned char>(c)]; };
    for (std::size_t i = 0; i < alphabet.size(); ++i) at(alphabet[i]) = static_cast<int>(i);
    for (const char c : {' ', '\n', '\r', '\t'}) at(c) = blank;
    at('=') = padding;
    return table;
}();

}  // namespace

std::string base64(std::string_view bytes) {
    std::string text((bytes.size() + 2) / 3 * 4, '=');
    std::size_t end = 0;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < count; ++k)
            group |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i + k])) << (16 - 8 * k);
        for (std::size_t k = 0; k <= count; ++k) text[end + k] = alphabet[group >> (18 - 6 * k) & 63U];
        end += 4;
    }
    return text;
}

std::optional<std::string> base64_decoded(std::string_view text, std::size_t count) {
    if (count > text.size()) return std::nullopt;
    std::string bytes;
    bytes.reserve(count);
    std::uint32_t group = 0;
    int bits = 0;
    for (std::size_t i = 0; i < text.size() && bytes.size() < count; ++i) {
        const int value = values[static_cast<unsigned char>(text[i])];
        if (value == blank) continue;
        if (value == foreign) return std::nullopt;
        if (value == padding) {  // the group is over, what is left of it are filling bits
            group = 0;
            bits = 0;
            continue;
        }
        group = group << 6 | static_cast<std::uint32_t>(value);
        bits += 6;
        if (bits < 8) continue;
        bits -= 8;
        bytes += static_cast<char>(group >> bits & 255U);
    }
    if (bytes.size() < count) return std::nullopt;
    return bytes;
}

}  // namespace pliant
