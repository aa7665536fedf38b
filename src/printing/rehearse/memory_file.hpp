// A file in memory only: it has a path while it exists, and vanishes with the program, however that ends.
#pragma once

#include <filesystem>
#include <string>

#include "base/core/error.hpp"
#include "base/core/file_handle.hpp"

namespace pliant::rehearse {

/// Movable. Its path is valid in this process only.
class MemoryFile {
public:
    /// Makes an empty file. Errors: the system does not support such files, or has no more of them.
    [[nodiscard]] static Result<MemoryFile> make();

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

private:
    explicit MemoryFile(int file);

    FileHandle file_;
    std::filesystem::path path_;
};

}  // namespace pliant::rehearse
