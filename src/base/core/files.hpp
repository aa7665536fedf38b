// Reading whole files with a size limit; writing to a temporary name and renaming, so no partial result is ever seen.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
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

/// How a folder of results is known, so that no other folder is ever deleted.
struct FolderMark {
    FolderMark(const char* file) : own(file) {}       // NOLINT(google-explicit-constructor): most have only this one
    FolderMark(std::string_view file) : own(file) {}  // NOLINT(google-explicit-constructor)
    FolderMark(std::string_view file, std::span<const std::string_view> others) : own(file), foreign(others) {}

    std::string_view own;                         ///< a file that is in it
    std::span<const std::string_view> foreign{};  ///< files of other results that have a file `own` as well
};

/// Whether a file, or a folder with its parents, can be made here, as far as that can be told beforehand: before work
/// whose results would be lost. Devices and pipes can be written to.
[[nodiscard]] Status check_file_place(const std::filesystem::path& path);
/// Errors: as of write_folder(), among them a mount point, which cannot be renamed.
[[nodiscard]] Status check_folder_place(const std::filesystem::path& path, const FolderMark& mark);
/// An error if `input` is there and lies, or leads, into `folder`, which is to be replaced.
[[nodiscard]] Status check_outside(const std::filesystem::path& input, const std::filesystem::path& folder);

/// `TARGET.partial`: what is written there is renamed to `target` once it is whole.
[[nodiscard]] std::filesystem::path aside_of(const std::filesystem::path& target);

/// The name of the folder with this ending, as of `DIR.checkpoint`: beside it, also of "DIR/" and ".".
[[nodiscard]] std::filesystem::path beside_folder(const std::filesystem::path& folder, std::string_view ending);

enum class AsideKind { file, folder };
/// Makes a file or folder that will be renamed to `target`, or empties what a program that was killed left there: a
/// folder holds `.begun` until it has its name, and one with other files and without it is somebody's own. No other
/// program gets it before the handle is closed; waits for one that has it, at most for `patience`.
[[nodiscard]] Result<FileHandle> open_aside(const std::filesystem::path& aside, AsideKind kind,
                                            const std::filesystem::path& target, std::chrono::milliseconds patience);

/// Writes `PATH.partial`, then renames it to the file that is replaced, whose permissions it gets. Devices, pipes and
/// the names of open files (/dev/stdout, /proc/self/fd) are written to directly.
[[nodiscard]] Status write_file(const std::filesystem::path& path, std::string_view bytes);

/// True if `folder` does not exist, is empty, or has the mark, so that no foreign folder is ever deleted.
[[nodiscard]] bool may_replace_folder(const std::filesystem::path& folder, const FolderMark& mark);

/// Calls `fill` on a new folder `DIR.partial` and, if it succeeds, renames it to DIR, or to the folder that DIR is a
/// link to. An existing DIR is replaced only if may_replace_folder() allows it.
[[nodiscard]] Status write_folder(const std::filesystem::path& folder, const FolderMark& mark,
                                  const std::function<Status(const std::filesystem::path&)>& fill);

}  // namespace pliant
