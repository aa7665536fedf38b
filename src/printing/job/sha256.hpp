// Fingerprints of entries: SHA-256 (FIPS 180-4), by Nettle.
#pragma once

#include <string>
#include <string_view>

namespace pliant::job {

/// 64 digits, lower case.
[[nodiscard]] std::string sha256_hex(std::string_view bytes);

/// Whether `text` could be one.
[[nodiscard]] bool is_sha256_hex(std::string_view text);

}  // namespace pliant::job
