// Reads a text file word by word and tracks the line number for messages. Lines end at "\n", "\r\n" or "\r".
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/core/error.hpp"

namespace pliant::mesh {

/// Without the byte order mark that some editors put in front of a text; any other bytes unchanged.
[[nodiscard]] std::string_view without_mark(std::string_view bytes);

class TextScanner {
public:
    TextScanner(std::string_view text, std::string name) : text_(text), name_(std::move(name)) {}

    /// The next word, on this line or a later one; "" at end of text.
    std::string_view word();
    /// The next word on this line; "" at end of line.
    std::string_view word_of_line();
    /// The rest of this line, without surrounding blanks; the scanner then is at the next line.
    std::string_view rest_of_line();
    /// Whether a backslash at the end of a line joins it with the next one, from here on. Off at first.
    void join_lines_at_backslash(bool join) { backslash_joins_ = join; }
    /// Skips blanks and comments (from `mark` to the end of the line), up to the next word.
    void skip_comments(char mark);
    /// The word read last, by any function.
    [[nodiscard]] std::string_view last_word() const { return last_word_; }
    [[nodiscard]] bool at_end() const { return at_ >= text_.size(); }
    [[nodiscard]] std::size_t bytes_left() const { return text_.size() - at_; }
    [[nodiscard]] std::size_t position() const { return at_; }
    [[nodiscard]] int line() const { return line_; }
    [[nodiscard]] const std::string& name() const { return name_; }
    /// Skips binary data, at most to the end of the text; `line()` is meaningless afterwards.
    void move_past(std::size_t bytes) { at_ += bytes < bytes_left() ? bytes : bytes_left(); }
    void move_to(std::size_t position) { at_ = position < text_.size() ? position : text_.size(); }

    /// The next word as a finite number, or an error that names it.
    [[nodiscard]] Result<double> number();
    [[nodiscard]] Result<std::int64_t> integer();
    /// A count of items of at least `least_bytes` each; an error if the rest of the text is too short for them.
    [[nodiscard]] Result<std::size_t> count(std::size_t least_bytes);

    /// "NAME:LINE: TEXT", for the line of the last word.
    [[nodiscard]] tl::unexpected<Error> error(std::string_view text) const;

private:
    void skip_blanks(bool over_lines);
    std::string_view take_word();
    [[nodiscard]] bool at_line_end() const;
    /// Length of a joining backslash and line end at this position; 0 if there is none.
    [[nodiscard]] std::size_t joint() const;

    std::string_view text_;
    std::string name_;
    std::size_t at_ = 0;
    int line_ = 1;
    bool backslash_joins_ = false;
    std::string_view last_word_;
};

}  // namespace pliant::mesh
