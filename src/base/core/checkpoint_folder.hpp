// The folder of a checkpoint: one process at a time works in it, and a power cut leaves what was there before, or
// after.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "base/core/error.hpp"
#include "base/core/file_handle.hpp"

namespace pliant {

/// Owns the lock of the folder, a lock on the file `lock` in it, which ends with the process, however it dies. On a
/// file system without locks nothing keeps others out. Movable.
class CheckpointFolder {
public:
    /// Makes the folder, or empties that of an older checkpoint, which is known by the file `mark`. Errors: anything
    /// else is there; another process is at work in it; it cannot be made.
    [[nodiscard]] static Result<CheckpointFolder> create(std::filesystem::path folder, std::string mark);
    /// A folder that is there. Errors: another process is at work in it; its lock cannot be opened.
    [[nodiscard]] static Result<CheckpointFolder> open(std::filesystem::path folder, std::string mark);
    /// Without the lock: to be removed.
    [[nodiscard]] static CheckpointFolder released(std::filesystem::path folder, std::string mark) {
        return {std::move(folder), std::move(mark), FileHandle()};
    }

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    /// Replaces a file of the folder. What was written, and what write() or sync() wrote to the disk before, outlives a
    /// power cut from then on; one in between leaves the old file.
    [[nodiscard]] Status write(const std::string& name, std::string_view bytes) const;
    /// Waits until the disk has all of a file of the folder.
    [[nodiscard]] Status sync(const std::string& name) const;

    /// From now on other processes may work in it, and delete it.
    void release() { lock_.close(); }
    /// Deletes it with all that is in it, unless another process has its lock or it is no checkpoint any more.
    [[nodiscard]] Status remove() const;

private:
    CheckpointFolder(std::filesystem::path folder, std::string mark, FileHandle lock)
        : path_(std::move(folder)), mark_(std::move(mark)), lock_(std::move(lock)) {}

    std::filesystem::path path_;
    std::string mark_;
    FileHandle lock_;
};

}  // namespace pliant
