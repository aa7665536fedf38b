#include "core/base64.hpp"

#include <cstddef>
#include <cstdint>

namespace pliant {

std::string base64(std::string_view bytes) {
    static constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
        }
        for (std::size_t k = 0; k < 4; ++k) {
            text += i + k > bytes.size() ? '=' : alphabet[group >> (18 - 6 * k) & 63U];
        }
    }
    return text;
}

namespace {

constexpr int blank = -1;
constexpr int padding = -2;
constexpr int foreign = -3;

int value_of(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    if (c == '+') return 62;
    if (c == '/') return 63;
    if (c == '=') return padding;
    return c == ' ' || c == '\n' || c == '\r' || c == '\t' ? blank : foreign;
}

}  // namespace

std::optional<std::string> base64_decoded(std::string_view text, std::size_t count) {
    if (count > text.size()) return std::nullopt;
    std::string bytes;
    bytes.reserve(count);
    std::uint32_t group = 0;
    int bits = 0;
    for (std::size_t i = 0; i < text.size() && bytes.size() < count; ++i) {
        const int value = value_of(text[i]);
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
