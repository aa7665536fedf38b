// Well-formed UTF-8: RFC 3629, the table in its section 4.
#pragma once

#include <cstddef>
#include <string_view>

namespace pliant {

/// Length in bytes of the character at the start of `text`, or 0 if it is malformed, or `text` empty.
[[nodiscard]] std::size_t utf8_length(std::string_view text);

[[nodiscard]] bool is_utf8(std::string_view text);

}  // namespace pliant
