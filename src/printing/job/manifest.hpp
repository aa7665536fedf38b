// The manifest as JSON. docs/reference/job.md describes every key.
#pragma once

#include <string>
#include <string_view>

#include "printing/job/job.hpp"

namespace pliant::job {

/// Formats of jobs without and with SHA-256 hashes.
inline constexpr int plain_format = 1, sealed_format = 2;

/// Whether a name is a valid entry of a job: a plain relative path such as "layers/00012_soft.png", of at most 200
/// printable characters, without empty, "." or ".." parts, backslashes or colons.
[[nodiscard]] bool is_safe_entry_name(std::string_view name);

[[nodiscard]] std::string to_json(const Manifest& manifest);

/// Parses and checks; the message starts with `where` and names the key.
[[nodiscard]] Result<Manifest> manifest_from_json(std::string_view json, std::string_view where);

}  // namespace pliant::job
