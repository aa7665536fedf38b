// A file without a place on a disk: it has a path while it lives, and is gone with the program, however that ends.
#pragma once

#include <filesystem>
#include <string>

#include "base/core/error.hpp"
#include "base/core/file_handle.hpp"

namespace pliant::rehearse {

/// Movable. Its path is of this process alone.
class MemoryFile {
public:
    /// Empty. Errors: the system has no such files, or no more of them.
    [[nodiscard]] static Result<MemoryFile> make();

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

private:
    explicit MemoryFile(int file);

    FileHandle file_;
    std::filesystem::path path_;
};

}  // namespace pliant::rehearse
