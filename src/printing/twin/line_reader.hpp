// The receiver of Marlin's serial protocol: splits bytes into lines, verifies line numbers and checksums.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace pliant::twin {

/// A line that the firmware accepts, or the reason why it does not.
struct ReceivedLine {
    std::string command;         ///< without number, checksum and comment
    std::optional<long> number;  ///< nullopt: the line had no number, and so was not verified
    std::string error;           ///< empty: accepted
    bool is_question = false;    ///< its number is so far ahead that no line can have been lost: a host asks for the
                                 ///< last one
};

/// Behaves like Marlin 2.1: a line that begins with N must carry the next number and the right checksum (number checked
/// first), and `M110` sets the number; any other line is accepted unverified. Lines are truncated at 95 characters; `;`
/// begins a comment; empty lines are ignored. With `drops_repeats` (2.1.2 and later) a line numbered as the last one,
/// or the one before it, is silently dropped before its checksum is verified.
class LineReader {
public:
    explicit LineReader(bool drops_repeats = false) : drops_repeats_(drops_repeats) {}

    /// The line completed by `byte`, if any.
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
    bool escape_ = false;  ///< after a backslash: the next character is literal
    long last_number_ = 0;
};

/// The xor of all bytes, as in `N<line> <command>*<xor>`.
[[nodiscard]] int checksum(std::string_view text);

}  // namespace pliant::twin
