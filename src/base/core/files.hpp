// Files in and out: read whole with a limit, written aside and renamed so that nothing half-made is ever seen.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "base/core/error.hpp"

namespace pliant {

/// The bytes of a regular file of at most `limit_bytes`.
[[nodiscard]] Result<std::string> read_file(const std::filesystem::path& path,
                                            std::uintmax_t limit_bytes = std::uintmax_t{4} << 30);

/// Writes `PATH.partial`, then renames it to PATH.
[[nodiscard]] Status write_file(const std::filesystem::path& path, std::string_view bytes);

/// True where `folder` is not there yet, is an empty folder, or one that holds a file `marker`: so that no foreign
/// folder is ever deleted.
[[nodiscard]] bool may_replace_folder(const std::filesystem::path& folder, std::string_view marker);

/// Calls `fill` on a fresh folder `DIR.partial` and, if it succeeds, puts that folder in the place of DIR. DIR is
/// replaced as may_replace_folder() allows.
[[nodiscard]] Status write_folder(const std::filesystem::path& folder, std::string_view marker,
                                  const std::function<Status(const std::filesystem::path&)>& fill);

}  // namespace pliant
