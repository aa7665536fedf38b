// Decodes an input into numbers and texts, for targets that do not take text: 0 and "" after the end of the input.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "input.hpp"

class Bytes {
public:
    Bytes(const std::uint8_t* data, std::size_t size) : left_(as_text(data, size)) {}

    [[nodiscard]] bool empty() const { return left_.empty(); }
    int byte() { return left_.empty() ? 0 : static_cast<unsigned char>(text(1)[0]); }
    /// 0 to `most`, which is at most 255.
    int up_to(int most) { return byte() % (most + 1); }
    /// -128 to 127.
    int signed_byte() { return static_cast<std::int8_t>(byte()); }
    bool chance() { return byte() % 2 == 1; }
    /// Any bit pattern of a double.
    double any_double() {
        double value = 0;
        const std::string_view raw = text(sizeof value);
        std::memcpy(&value, raw.data(), raw.size());
        return value;
    }
    /// Up to `count` bytes, fewer at the end of the input.
    std::string_view text(std::size_t count) {
        const std::string_view taken = left_.substr(0, count);
        left_.remove_prefix(taken.size());
        return taken;
    }
    std::string_view rest() { return text(left_.size()); }

private:
    std::string_view left_;
};
