#include "geometry/files/vtu_skeleton.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <system_error>

namespace pliant::mesh {
namespace {

/// Begins a placeholder, before the number of its array: this character is not allowed in XML.
constexpr char begin_of_mark = '\x01';

/// The position after a tag's '>'; one inside an attribute value does not count.
std::size_t end_of_tag(std::string_view text, std::size_t at) {
    char quote = 0;
    for (; at < text.size(); ++at) {
        const char c = text[at];
        if (quote != 0)
            quote = c == quote ? '\0' : quote;
        else if (c == '"' || c == '\'')
            quote = c;
        else if (c == '>')
            return at + 1;
    }
    return std::string_view::npos;
}

}  // namespace

VtuSkeleton::VtuSkeleton(std::string_view text) {
    constexpr std::string_view begin_of_array = "<DataArray";
    constexpr std::size_t small = 256;  // bytes; smaller arrays are kept in place
    std::size_t copied = 0;
    for (std::size_t tag = text.find(begin_of_array); tag != std::string_view::npos;
         tag = text.find(begin_of_array, tag)) {
        const std::size_t begin = end_of_tag(text, tag);
        tag = begin;
        if (begin == std::string_view::npos) break;
        const std::size_t end = text.find('<', begin);
        if (text[begin - 2] == '/' || end == std::string_view::npos || end - begin < small) continue;
        xml_ += text.substr(copied, begin - copied);
        xml_ += fmt::format("{}{}", begin_of_mark, arrays_.size());
        arrays_.push_back(text.substr(begin, end - begin));
        copied = tag = end;
        cuts_.push_back({xml_.size(), end - xml_.size()});
    }
    xml_ += text.substr(copied);
}

std::string_view VtuSkeleton::original(std::string_view text) const {
    if (!text.starts_with(begin_of_mark)) return text;
    std::size_t number = 0;
    const char* last = text.data() + text.size();
    const auto [end, code] = std::from_chars(text.data() + 1, last, number);
    const bool known = code == std::errc() && end == last && number < arrays_.size();
    return known ? arrays_[number] : text;
}

std::size_t VtuSkeleton::place_in_file(std::size_t at) const {
    const auto next =
        std::upper_bound(cuts_.begin(), cuts_.end(), at, [](std::size_t a, const Cut& cut) { return a < cut.at; });
    return next == cuts_.begin() ? at : at + (next - 1)->left_out;
}

}  // namespace pliant::mesh
