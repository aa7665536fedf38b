#include "printing/twin/line_reader.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

namespace pliant::twin {
namespace {

constexpr std::size_t most_chars = 95;

std::string_view trim(std::string_view text) {
    while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
    while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
    return text;
}

/// The number at the beginning of `text`; the rest is ignored, and no number is 0: like strtol.
long leading_number(std::string_view text) {
    while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
    long value = 0;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

}  // namespace

int checksum(std::string_view text) {
    int sum = 0;
    for (const char c : text) sum ^= static_cast<unsigned char>(c);
    return sum;
}

std::optional<ReceivedLine> LineReader::feed(char byte) {
    if (byte == '\n' || byte == '\r') return finish();
    const bool escaped = std::exchange(escape_, false);
    if (byte == '\\' && !escaped && !comment_) {
        escape_ = true;
        return std::nullopt;
    }
    if (byte == ';' && !escaped) comment_ = true;
    if (byte == '\b') {
        if (!line_.empty()) line_.pop_back();
    } else if (!comment_ && line_.size() < most_chars) {
        line_ += byte;
    }
    return std::nullopt;
}

std::optional<ReceivedLine> LineReader::finish() {
    const std::string line = std::exchange(line_, {});
    comment_ = false;
    escape_ = false;
    if (line.empty()) return std::nullopt;
    return verify(trim(line));
}

std::optional<ReceivedLine> LineReader::verify(std::string_view line) {
    ReceivedLine result;
    const std::size_t star = line.rfind('*');
    if (line.empty() || line.front() != 'N') {
        result.command = trim(line.substr(0, star));
        return result;
    }
    // Marlin looks for M110 anywhere in the line, and for its N from the fifth character on.
    const bool sets_number = line.find("M110") != std::string_view::npos;
    const std::size_t second = sets_number ? line.find('N', 4) : std::string_view::npos;
    const long number = leading_number(line.substr(second == std::string_view::npos ? 1 : second + 1));
    const bool follows = sets_number || number == last_number_ + 1;
    if (!follows && drops_repeats_ && (number == last_number_ || number == last_number_ - 1)) return std::nullopt;
    constexpr long far_ahead = 1'000'000'000;
    result.is_question = !follows && number > last_number_ + far_ahead;
    if (!follows) {
        result.error = "Line Number is not Last Line Number+1";
    } else if (star == std::string_view::npos) {
        result.error = "No Checksum with line number";
    } else if (leading_number(line.substr(star + 1)) != checksum(line.substr(0, star))) {
        result.error = "checksum mismatch";
    } else {
        last_number_ = number;
        result.number = number;
        const std::size_t blank = std::min(line.find(' '), star);
        result.command = blank == star ? "" : trim(line.substr(blank + 1, star - blank - 1));
    }
    return result;
}

}  // namespace pliant::twin
