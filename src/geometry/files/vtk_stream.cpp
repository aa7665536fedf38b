#include "geometry/files/vtk_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <map>

#include "base/core/byte_order.hpp"
#include "geometry/files/number_type.hpp"

namespace pliant::mesh {
namespace {

/// By its name in a file. Width 0: unknown.
NumberType vtk_number_type(const std::string& name) {
    static const std::map<std::string, NumberType> types = {
        {"float", {4, true}},
        {"double", {8, true}},
        {"int", {4}},
        {"unsigned_int", {4, false, false}},
        {"long", {8}},
        {"unsigned_long", {8, false, false}},
        {"vtktypeint64", {8}},
        {"vtkIdType", {8}},
        {"vtktypeuint64", {8, false, false}},
        {"vtktypeint32", {4}},
        {"short", {2}},
        {"unsigned_short", {2, false, false}},
        {"char", {1}},
        {"unsigned_char", {1, false, false}},
    };
    const auto found = types.find(name);
    return found == types.end() ? NumberType{} : found->second;
}

/// The first `width` bytes, big-endian.
std::uint64_t big_endian_bits(std::string_view bytes, std::size_t width) {
    if (width == 8) {
        std::uint64_t value = 0;
        std::memcpy(&value, bytes.data(), 8);
        return byte_swapped(value);
    }
    if (width == 4) {
        std::uint32_t value = 0;
        std::memcpy(&value, bytes.data(), 4);
        return byte_swapped(value);
    }
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < width; ++i) value = value << 8U | static_cast<unsigned char>(bytes[i]);
    return value;
}

}  // namespace

tl::unexpected<Error> VtkStream::error(const std::string& text) const {
    const auto here = bytes_.begin() + static_cast<std::ptrdiff_t>(std::min(at_, bytes_.size()));
    return input_error_at(name_, 1 + static_cast<int>(std::count(bytes_.begin(), here, '\n')), "{}", text);
}

std::string_view VtkStream::next_line() {
    const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
    std::string_view text = bytes_.substr(at_, end - at_);
    at_ = std::min(end + 1, bytes_.size());
    if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
    return text;
}

std::string VtkStream::next_word() {
    while (at_ < bytes_.size() && is_blank(bytes_[at_])) ++at_;
    const std::size_t begin = at_;
    while (at_ < bytes_.size() && !is_blank(bytes_[at_])) ++at_;
    return std::string(bytes_.substr(begin, at_ - begin));
}

Status VtkStream::read_count(std::size_t& count) {
    const std::string word = next_word();
    const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), count);
    if (code == std::errc() && end == word.data() + word.size()) return {};
    return error(fmt::format("a count is needed instead of \"{}\"", word.substr(0, 40)));
}

Result<std::vector<double>> VtkStream::read_numbers(std::size_t count, const std::string& type_name) {
    const NumberType type = vtk_number_type(type_name);
    const std::size_t width = type.width;
    if (width == 0) return error(fmt::format("unknown data type \"{}\"", type_name.substr(0, 40)));
    if (binary_ && at_ < bytes_.size() && bytes_[at_] == '\r') ++at_;
    if (binary_ && at_ < bytes_.size() && bytes_[at_] == '\n') ++at_;
    const std::size_t left = bytes_.size() - at_;
    std::vector<double> numbers;
    if (binary_) {
        if (count > left / width) return error(fmt::format("{} values are announced, the file ends before", count));
        numbers.reserve(count);
        for (std::size_t i = 0; i < count; ++i, at_ += width)
            numbers.push_back(number_of_bits(type, big_endian_bits(bytes_.substr(at_, width), width)));
        return numbers;
    }
    if (count > left / 2 + 1) return error(fmt::format("{} values are announced, the file ends before", count));
    numbers.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        const std::string word = next_word();
        const char* begin = word.data() + (!word.empty() && word.front() == '+' ? 1 : 0);
        double value = 0;
        const auto [end, code] = std::from_chars(begin, word.data() + word.size(), value);
        if (word.empty() || code != std::errc() || end != word.data() + word.size()) {
            return error(word.empty() ? "the file ends in the middle of an array"
                                      : fmt::format("\"{}\" is not a number", word.substr(0, 40)));
        }
        numbers.push_back(value);
    }
    return numbers;
}

/// The top two bits of the first byte give the number of bytes of the length: 3: one, 2: two, 1: four, 0: eight.
std::string_view VtkStream::next_binary_string() {
    const unsigned first = static_cast<unsigned char>(bytes_[at_]);
    const std::size_t width = std::size_t{1} << (3 - (first >> 6U));
    std::uint64_t length = first & 63U;
    for (std::size_t k = 1; k < width && at_ + k < bytes_.size(); ++k)
        length = length << 8U | static_cast<unsigned char>(bytes_[at_ + k]);
    at_ = std::min(at_ + width, bytes_.size());
    const std::string_view text = bytes_.substr(at_, std::min<std::uint64_t>(length, bytes_.size() - at_));
    at_ += text.size();
    return text;
}

}  // namespace pliant::mesh
