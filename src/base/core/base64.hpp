// Base64 (RFC 4648, with padding): bytes inside text formats such as VTK's XML files and HTML pages.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace pliant {

[[nodiscard]] std::string base64(std::string_view bytes);

/// Decodes the first `count` bytes of the text. White space is skipped, and several padded pieces may follow each
/// other. Nothing if the text ends too early or contains an invalid character before that.
[[nodiscard]] std::optional<std::string> base64_decoded(std::string_view text, std::size_t count);

}  // namespace pliant
