// SHA-256 hashes of entries (FIPS 180-4), by Nettle.
#pragma once

#include <string>
#include <string_view>

namespace pliant::job {

/// 64 digits, lower case.
[[nodiscard]] std::string sha256_hex(std::string_view bytes);

/// Whether `text` has the form of a hash.
[[nodiscard]] bool is_sha256_hex(std::string_view text);

}  // namespace pliant::job
