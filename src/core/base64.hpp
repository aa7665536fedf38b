// Base64 (RFC 4648, with padding): bytes inside text formats such as VTK's XML files and HTML pages.
#pragma once

#include <string>
#include <string_view>

namespace pliant {

[[nodiscard]] std::string base64(std::string_view bytes);

}  // namespace pliant
