// Reading whole files with a size limit; writing to a temporary name and renaming, so no partial result is ever seen.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "base/core/error.hpp"

namespace pliant {

/// The contents of a regular file of at most `limit_bytes`.
[[nodiscard]] Result<std::string> read_file(const std::filesystem::path& path,
                                            std::uintmax_t limit_bytes = std::uintmax_t{4} << 30);

/// The file that is replaced when `path` is written: where its symbolic links lead, or `path` itself if nothing is
/// there. Errors: a folder, a device or a pipe, which a rename would destroy.
[[nodiscard]] Result<std::filesystem::path> replaceable_file(const std::filesystem::path& path);

/// Writes `PATH.partial`, then renames it to the file that is replaced. Devices, pipes and the names of open files
/// (/dev/stdout, /proc/self/fd) are written to directly.
[[nodiscard]] Status write_file(const std::filesystem::path& path, std::string_view bytes);

/// True if `folder` does not exist, is empty, or contains a file named `marker`, so that no foreign folder is ever
/// deleted.
[[nodiscard]] bool may_replace_folder(const std::filesystem::path& folder, std::string_view marker);

/// Calls `fill` on a new folder `DIR.partial` and, if it succeeds, renames it to DIR. An existing DIR is replaced only
/// if may_replace_folder() allows it.
[[nodiscard]] Status write_folder(const std::filesystem::path& folder, std::string_view marker,
                                  const std::function<Status(const std::filesystem::path&)>& fill);

}  // namespace pliant
