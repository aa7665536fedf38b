#include "printed.hpp"

namespace pliant::app {
namespace {

/// Those of Unicode from U+0080 to U+009F are the bytes C2 80 to C2 9F.
bool is_wide_control(std::string_view text, std::size_t at) {
    if (text[at] != '\xc2' || at + 1 >= text.size()) return false;
    const auto next = static_cast<unsigned char>(text[at + 1]);
    return next >= 0x80 && next <= 0x9f;
}

std::string visible(std::string_view text, bool keep_lines) {
    std::string out;
    for (std::size_t at = 0; at < text.size(); ++at) {
        const auto c = static_cast<unsigned char>(text[at]);
        if (c == '\n' && !keep_lines)
            out += "\\n";
        else if (c == '\n' || c == '\t' || (c >= ' ' && c != 0x7f && !is_wide_control(text, at)))
            out += text[at];
        else if (c < 0x80)
            out += fmt::format("\\x{:02x}", c);
        else
            out += fmt::format("\\u{:04x}", static_cast<unsigned char>(text[++at]));
    }
    return out;
}

}  // namespace

std::string one_line(std::string_view text) {
    return visible(text, false);
}

std::string visible_lines(std::string_view text) {
    return visible(text, true);
}

}  // namespace pliant::app
