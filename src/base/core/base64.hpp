// Base64 (RFC 4648, with padding): bytes inside text formats such as VTK's XML files and HTML pages.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace pliant {

[[nodiscard]] std::string base64(std::string_view bytes);

/// The first `count` bytes that the text stands for. White space is passed over, and padded pieces may follow each
/// other. Nothing if the text ends before, or holds another sign first.
[[nodiscard]] std::optional<std::string> base64_decoded(std::string_view text, std::size_t count);

}  // namespace pliant
