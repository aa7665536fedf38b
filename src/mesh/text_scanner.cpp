#include "mesh/text_scanner.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace pliant::mesh {
namespace {

bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v';
}

std::string_view shortened(std::string_view word) {
    return word.substr(0, 40);
}

}  // namespace

void TextScanner::skip_blanks(bool over_lines) {
    for (; at_ < text_.size(); ++at_) {
        if (text_[at_] == '\n' && over_lines)
            ++line_;
        else if (!is_blank(text_[at_]))
            return;
    }
}

std::string_view TextScanner::take_word() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && !is_blank(text_[at_]) && text_[at_] != '\n') ++at_;
    return text_.substr(begin, at_ - begin);
}

std::string_view TextScanner::word() {
    skip_blanks(true);
    return take_word();
}

std::string_view TextScanner::word_of_line() {
    skip_blanks(false);
    return take_word();
}

std::string_view TextScanner::rest_of_line() {
    skip_blanks(false);
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string_view rest = text_.substr(at_, end - at_);
    while (!rest.empty() && is_blank(rest.back())) rest.remove_suffix(1);
    at_ = std::min(end + 1, text_.size());
    line_ += end < text_.size() ? 1 : 0;
    return rest;
}

Result<double> TextScanner::number() {
    const std::string_view text = word();
    const std::string_view digits = text.substr(text.starts_with('+') ? 1 : 0);
    double value = 0;
    const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (code == std::errc() && end == digits.data() + digits.size() && std::isfinite(value)) return value;
    if (text.empty()) return error("the file ends where a number is needed");
    return error(fmt::format("\"{}\" is not a finite number", shortened(text)));
}

Result<std::int64_t> TextScanner::integer() {
    const std::string_view text = word();
    std::int64_t value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (!text.empty() && code == std::errc() && end == text.data() + text.size()) return value;
    if (text.empty()) return error("the file ends where a whole number is needed");
    return error(fmt::format("\"{}\" is not a whole number", shortened(text)));
}

Result<std::size_t> TextScanner::count(std::size_t least_bytes) {
    const Result<std::int64_t> value = integer();
    if (!value) return tl::unexpected(value.error());
    if (*value >= 0 && static_cast<std::uint64_t>(*value) <= bytes_left() / least_bytes + 1)
        return static_cast<std::size_t>(*value);
    return error(fmt::format("{} are announced, more than the file can hold", *value));
}

tl::unexpected<Error> TextScanner::error(std::string_view text) const {
    return input_error("{}:{}: {}", name_, line_, text);
}

}  // namespace pliant::mesh
