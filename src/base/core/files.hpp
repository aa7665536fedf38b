// Reading whole files with a size limit; writing to a temporary name and renaming, so no partial result is ever seen.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "base/core/error.hpp"
#include "base/core/file_handle.hpp"

namespace pliant {

/// ".toml", also of PART.TOML.
[[nodiscard]] std::string lower_extension(const std::filesystem::path& path);

/// The contents of a regular file of at most `limit_bytes`.
[[nodiscard]] Result<std::string> read_file(const std::filesystem::path& path,
                                            std::uintmax_t limit_bytes = std::uintmax_t{4} << 30);

/// The file that is replaced when `path` is written: where its symbolic links lead, or `path` itself if nothing is
/// there. Errors: a folder, a device or a pipe, which a rename would destroy.
[[nodiscard]] Result<std::filesystem::path> replaceable_file(const std::filesystem::path& path);

/// Whether a file, or a folder with its parents, can be made here, as far as that can be told beforehand: before work
/// whose results would be lost. Devices and pipes can be written to.
[[nodiscard]] Status check_file_place(const std::filesystem::path& path);
/// `marker`: as of write_folder().
[[nodiscard]] Status check_folder_place(const std::filesystem::path& path, std::string_view marker);

/// `TARGET.partial`: what is written there is renamed to `target` once it is whole.
[[nodiscard]] std::filesystem::path aside_of(const std::filesystem::path& target);

/// The name of the folder with this ending, as of `DIR.checkpoint`: beside it, also of "DIR/" and ".".
[[nodiscard]] std::filesystem::path beside_folder(const std::filesystem::path& folder, std::string_view ending);

enum class AsideKind { file, folder };
/// Makes a file or folder that will be renamed to `target`, or empties what a program that was killed left there. No
/// other program gets it before the handle is closed; waits for one that has it, at most for `patience`.
[[nodiscard]] Result<FileHandle> open_aside(const std::filesystem::path& aside, AsideKind kind,
                                            const std::filesystem::path& target, std::chrono::milliseconds patience);

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
