// Options of a slice: an accepted number is valid and within its limits.
#include "printing/prepare/option_text.hpp"

#include <cmath>
#include <string>

#include "input.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace pliant::prepare;
    const std::string text(as_text(data, size));
    const auto length = length_um("--spacing", text, 5);
    if (length && !std::isfinite(*length)) __builtin_trap();
    const auto limited = length_um("--spacing", text, 5, 1, 1000);
    if (limited && !(*limited > 0.999999 && *limited < 1000.000001) && !text.empty()) __builtin_trap();
    const auto layer = layer_height_um("--layer", text);
    if (layer && !(*layer >= 1 && *layer <= 1000)) __builtin_trap();
    if (plain_number(text) < -1) __builtin_trap();
    const auto degrees = plain_degrees("--turn", text);
    if (degrees && !std::isfinite(*degrees)) __builtin_trap();
    return 0;
}
