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

/// The value of each character.
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
    std::string bytes(count, '\0');
    std::size_t filled = 0;
    std::uint32_t group = 0;
    int bits = 0;
    const auto value_at = [&](std::size_t i) { return values[static_cast<unsigned char>(text[i])]; };
    for (std::size_t i = 0; i < text.size() && filled < count; ++i) {
        // Fast path: whole groups of four ordinary characters, which is nearly all of any text.
        for (; bits == 0 && i + 4 <= text.size() && filled + 3 <= count; i += 4, filled += 3) {
            const int a = value_at(i), b = value_at(i + 1), c = value_at(i + 2), d = value_at(i + 3);
            if ((a | b | c | d) < 0) break;
            const auto four = static_cast<std::uint32_t>(a << 18 | b << 12 | c << 6 | d);
            bytes[filled] = static_cast<char>(four >> 16);
            bytes[filled + 1] = static_cast<char>(four >> 8 & 255U);
            bytes[filled + 2] = static_cast<char>(four & 255U);
        }
        if (i == text.size() || filled == count) break;
        const int value = value_at(i);
        if (value == blank) continue;
        if (value == foreign) return std::nullopt;
        if (value == padding) {  // end of the padded group: the remaining bits are padding
            group = 0;
            bits = 0;
            continue;
        }
        group = group << 6 | static_cast<std::uint32_t>(value);
        bits += 6;
        if (bits < 8) continue;
        bits -= 8;
        bytes[filled++] = static_cast<char>(group >> bits & 255U);
    }
    if (filled < count) return std::nullopt;
    return bytes;
}

}  // namespace pliant
