// The settings of a C header in Marlin's style: `#define NAME value  // comment`, or `//#define NAME` when disabled.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace pliant::machine {

/// One place where a header defines a name, active or commented out.
struct DefineLine {
    std::string name;
    std::string value;           ///< as written, continuation lines joined by a space; empty: none
    bool active = false;         ///< not commented out
    std::size_t first_line = 0;  ///< index of its line
    std::size_t lines = 1;       ///< more where a line ends in a backslash
};

/// A header as lines, whose settings can be changed in place; everything else is preserved byte by byte.
/// Names in block comments and macros with arguments are not settings.
class DefineLines {
public:
    explicit DefineLines(std::string_view text);

    /// All places of `name`, in order; there may be several in branches of an #if.
    [[nodiscard]] std::vector<DefineLine> find(std::string_view name) const;

    /// Defines `name` in all its places: "on" uncomments it and keeps a value, "off" comments it out, anything else
    /// becomes its value. Indentation and trailing comments are preserved.
    void set(std::string_view name, std::string_view value);

    /// Adds a line at the end of the header.
    void append(std::string_view line);

    [[nodiscard]] std::string text() const;

private:
    struct Line {
        std::string text, end;  ///< `end`: "\n" or "\r\n"; the last line may have none
    };

    void scan();

    std::vector<Line> lines_;
    std::vector<DefineLine> defines_;
};

}  // namespace pliant::machine
