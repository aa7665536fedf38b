// Tells whether a file is still the one that was read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "base/core/error.hpp"

namespace pliant::studio {

/// Another file under the same name has another stamp, and so has the file once it is written again.
struct FileStamp {
    std::uintmax_t device = 0, file = 0, size = 0;
    std::int64_t changed_s = 0, changed_ns = 0;
    bool operator==(const FileStamp&) const = default;
};

/// Of the file to which the path leads; nullopt: there is none.
[[nodiscard]] std::optional<FileStamp> stamp_of(const std::filesystem::path& path);

/// Error: another file, or another content, is there than when it had this stamp. One that is gone is none: whoever
/// reads it says so.
[[nodiscard]] Status check_unchanged(const std::filesystem::path& path, const std::optional<FileStamp>& stamp);

}  // namespace pliant::studio
