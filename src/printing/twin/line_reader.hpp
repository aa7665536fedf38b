// The receiving end of Marlin's wire: bytes become lines, line numbers and checksums are verified.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace pliant::twin {

/// A line that the firmware takes, or the reason why it does not.
struct ReceivedLine {
    std::string command;         ///< without number, checksum and comment
    std::optional<long> number;  ///< nullopt: the line was not numbered, and so not verified
    std::string error;           ///< empty: good
    bool is_question = false;    ///< so far ahead that no line can have been lost: a host asks for the last one
};

/// Follows Marlin 2.1: a line that begins with N must carry the next number and the right checksum (number first), and
/// `M110` sets the number; any other line is taken unverified. Lines are cut at 95 characters; `;` begins a comment;
/// empty lines are no lines. With `drops_repeats` (2.1.2 and later) a line numbered as the last one, or the one before
/// it, is no line either: it is dropped in silence, before its checksum is looked at.
class LineReader {
public:
    explicit LineReader(bool drops_repeats = false) : drops_repeats_(drops_repeats) {}

    /// The line that `byte` ends, if it ends one.
    [[nodiscard]] std::optional<ReceivedLine> feed(char byte);

    [[nodiscard]] long last_number() const { return last_number_; }
    void set_last_number(long number) { last_number_ = number; }
    void reset() { *this = LineReader(drops_repeats_); }

private:
    [[nodiscard]] std::optional<ReceivedLine> finish();
    [[nodiscard]] std::optional<ReceivedLine> verify(std::string_view line);

    bool drops_repeats_;
    std::string line_;
    bool comment_ = false;
    bool escape_ = false;  ///< a backslash: the next character loses its meaning
    long last_number_ = 0;
};

/// The xor of all bytes, as `N<line> <command>*<xor>` carries it.
[[nodiscard]] int checksum(std::string_view text);

}  // namespace pliant::twin
