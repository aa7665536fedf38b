// Numbers and texts out of an input, for targets whose input is no text: 0 and "" where it has come to its end.
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
    /// 0 to `most`, which is 255 at the most.
    int up_to(int most) { return byte() % (most + 1); }
    /// -128 to 127.
    int signed_byte() { return static_cast<std::int8_t>(byte()); }
    bool chance() { return byte() % 2 == 1; }
    /// Any double there is.
    double any_double() {
        double value = 0;
        const std::string_view raw = text(sizeof value);
        std::memcpy(&value, raw.data(), raw.size());
        return value;
    }
    /// As many bytes as there are, at most `count`.
    std::string_view text(std::size_t count) {
        const std::string_view taken = left_.substr(0, count);
        left_.remove_prefix(taken.size());
        return taken;
    }
    std::string_view rest() { return text(left_.size()); }

private:
    std::string_view left_;
};
