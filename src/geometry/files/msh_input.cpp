#include "geometry/files/msh_input.hpp"

#include <bit>
#include <cmath>
#include <cstring>

#include "base/core/byte_order.hpp"

namespace pliant::mesh {

static_assert(std::endian::native == std::endian::little, "numbers are taken as they lie in the file");

Status MshInput::begin_binary(bool wide_sizes) {
    binary_ = true;
    wide_ = wide_sizes;
    scan_.rest_of_line();
    const Result<std::int64_t> one = integer();
    if (!one) return tl::unexpected(one.error());
    swapped_ = *one == (1 << 24);
    if (*one != 1 && !swapped_) return error("the whole number 1 is needed here, in either byte order");
    return {};
}

void MshInput::skip_line_end() {
    if (binary_) scan_.rest_of_line();
}

Status MshInput::skip_section(std::string_view head) {
    if (!binary_) {
        while (!scan_.at_end() && !scan_.rest_of_line().starts_with("$End")) {
        }
        return {};
    }
    const std::string end = fmt::format("$End{}", head.substr(1));
    const std::size_t at = bytes_.find(end, scan_.position());
    if (at == std::string_view::npos) return error(fmt::format("the file ends before {}", end.substr(0, 40)));
    scan_.move_to(at);
    scan_.rest_of_line();
    return {};
}

Status MshInput::expect_end() {
    const std::string_view end = scan_.word();
    if (end.starts_with("$End")) return {};
    return error(fmt::format("the end of the section is needed instead of \"{}\"", end.substr(0, 40)));
}

bool MshInput::next_bits(std::size_t width, std::uint64_t& bits) {
    if (width > scan_.bytes_left()) return false;
    const char* at = bytes_.data() + scan_.position();
    bits = 0;
    std::memcpy(&bits, at, width);
    if (swapped_) bits = width == 8 ? byte_swapped(bits) : byte_swapped(static_cast<std::uint32_t>(bits));
    scan_.move_past(width);
    return true;
}

Result<std::int64_t> MshInput::integer() {
    if (!binary_) return scan_.integer();
    std::uint64_t bits = 0;
    if (!next_bits(4, bits)) return error("the file ends where a whole number is needed");
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(bits));
}

Result<std::int64_t> MshInput::size() {
    if (!binary_) return scan_.integer();
    std::uint64_t bits = 0;
    if (!next_bits(size_width(), bits)) return error("the file ends where a whole number is needed");
    return static_cast<std::int64_t>(bits);
}

Result<double> MshInput::number() {
    if (!binary_) return scan_.number();
    std::uint64_t bits = 0;
    if (!next_bits(8, bits)) return error("the file ends where a number is needed");
    const auto value = std::bit_cast<double>(bits);
    if (!std::isfinite(value)) return error("a number is not finite");
    return value;
}

Result<std::size_t> MshInput::count(std::size_t least_bytes) {
    if (!binary_) return scan_.count(least_bytes);
    const Result<std::int64_t> value = size();
    if (!value) return tl::unexpected(value.error());
    if (*value >= 0 && static_cast<std::uint64_t>(*value) <= scan_.bytes_left() / least_bytes)
        return static_cast<std::size_t>(*value);
    return error(fmt::format("{} are announced, more than the file can hold", *value));
}

Status MshInput::skip_bytes(std::size_t rows, std::size_t width) {
    if (rows > scan_.bytes_left() / width) return error("the file ends in the middle of its elements");
    scan_.move_past(rows * width);
    return {};
}

tl::unexpected<Error> MshInput::error(std::string_view text) const {
    if (!binary_) return scan_.error(text);
    return input_error("{}: byte {}: {}", name_, scan_.position(), text);
}

}  // namespace pliant::mesh
