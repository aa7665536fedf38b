#include "geometry/files/text_scanner.hpp"

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

std::string_view without_mark(std::string_view bytes) {
    constexpr std::string_view mark = "\xEF\xBB\xBF";
    const bool text = bytes.substr(0, 4096).find('\0') == std::string_view::npos;
    return bytes.substr(text && bytes.starts_with(mark) ? mark.size() : 0);
}

/// In "\r\n" the second character ends the line; the first counts as a blank.
bool TextScanner::at_line_end() const {
    return text_[at_] == '\n' || (text_[at_] == '\r' && text_.substr(at_ + 1, 1) != "\n");
}

std::size_t TextScanner::joint() const {
    if (!backslash_joins_ || text_[at_] != '\\') return 0;
    const std::string_view after = text_.substr(at_ + 1, 2);
    if (after == "\r\n") return 3;
    return after.starts_with('\n') || after.starts_with('\r') ? 2 : 0;
}

void TextScanner::skip_blanks(bool over_lines) {
    while (at_ < text_.size()) {
        if (const std::size_t bytes = joint(); bytes > 0) {
            ++line_;
            at_ += bytes;
            continue;
        }
        const bool line_end = at_line_end();
        if (line_end ? !over_lines : !is_blank(text_[at_])) return;
        line_ += line_end ? 1 : 0;
        ++at_;
    }
}

std::string_view TextScanner::take_word() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && !is_blank(text_[at_]) && text_[at_] != '\n' && joint() == 0) ++at_;
    return last_word_ = text_.substr(begin, at_ - begin);
}

void TextScanner::skip_comments(char mark) {
    for (skip_blanks(true); at_ < text_.size() && text_[at_] == mark; skip_blanks(true)) rest_of_line();
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
    const std::size_t begin = at_;
    while (at_ < text_.size() && !at_line_end()) {
        at_ = std::min(text_.find_first_of("\r\n", at_ + 1), text_.size());
    }
    std::string_view rest = text_.substr(begin, at_ - begin);
    while (!rest.empty() && is_blank(rest.back())) rest.remove_suffix(1);
    if (at_ < text_.size()) {
        ++at_;
        ++line_;
    }
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
    return input_error_at(name_, line_, "{}", text);
}

}  // namespace pliant::mesh
