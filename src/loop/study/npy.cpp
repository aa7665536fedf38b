#include "loop/study/npy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace pliant::study {
namespace {

/// Magic number, version, and a Python dictionary padded to a multiple of 64 bytes.
std::string header(const std::string& type, std::size_t count) {
    constexpr std::size_t align = 64, before = 10;
    std::string text = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({},), }}", type, count);
    text.append(align - 1 - (before + text.size()) % align, ' ');
    text += '\n';
    std::string bytes("\x93NUMPY\x01\x00", 8);
    bytes += static_cast<char>(text.size() & 0xffU);
    bytes += static_cast<char>(text.size() >> 8);
    return bytes + text;
}

/// The next code point of UTF-8, or U+FFFD for an invalid byte.
char32_t take_letter(std::string_view& text) {
    const auto byte = [&text](std::size_t k) { return static_cast<unsigned char>(text[k]); };
    const std::size_t length = byte(0) < 0x80       ? 1
                               : byte(0) >> 5 == 6  ? 2
                               : byte(0) >> 4 == 14 ? 3
                               : byte(0) >> 3 == 30 ? 4
                                                    : 0;
    char32_t letter = length == 1 ? byte(0) : length == 0 ? 0 : byte(0) & (0xffU >> (length + 1));
    bool good = length > 0 && length <= text.size();
    for (std::size_t k = 1; good && k < length; ++k) {
        good = byte(k) >> 6 == 2;
        letter = letter << 6 | (byte(k) & 0x3fU);
    }
    good = good && letter <= 0x10ffff && !(letter >= 0xd800 && letter < 0xe000);
    text.remove_prefix(good ? length : 1);
    return good ? letter : char32_t{0xfffd};
}

}  // namespace

std::string npy_numbers(std::span<const double> numbers) {
    std::string bytes = header("<f8", numbers.size());
    for (const double number : numbers) {
        std::uint64_t bits = 0;
        std::memcpy(&bits, &number, sizeof bits);
        for (unsigned k = 0; k < sizeof bits; ++k) bytes += static_cast<char>(bits >> (8 * k) & 0xffU);
    }
    return bytes;
}

std::string npy_truths(const std::vector<bool>& truths) {
    std::string bytes = header("|b1", truths.size());
    for (const bool truth : truths) bytes += truth ? '\1' : '\0';
    return bytes;
}

std::string npy_texts(std::span<const std::string> texts, std::size_t most_letters) {
    std::vector<std::u32string> letters;
    std::size_t longest = 1;
    for (std::string_view text : texts) {
        std::u32string& word = letters.emplace_back();
        while (!text.empty() && word.size() < most_letters) word += take_letter(text);
        longest = std::max(longest, word.size());
    }
    std::string bytes = header(fmt::format("<U{}", longest), texts.size());
    bytes.reserve(bytes.size() + 4 * longest * texts.size());
    for (const std::u32string& word : letters) {
        for (const char32_t letter : word) {
            for (unsigned k = 0; k < 4; ++k) bytes += static_cast<char>(letter >> (8 * k) & 0xffU);
        }
        bytes.append(4 * (longest - word.size()), '\0');
    }
    return bytes;
}

}  // namespace pliant::study
