#include "printing/rehearse/memory_file.hpp"

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace pliant::rehearse {

MemoryFile::MemoryFile(int file) : file_(file), path_(fmt::format("/proc/self/fd/{}", file)) {}

MemoryFile::MemoryFile(MemoryFile&& other) noexcept
    : file_(std::exchange(other.file_, -1)), path_(std::move(other.path_)) {}

MemoryFile& MemoryFile::operator=(MemoryFile&& other) noexcept {
    std::swap(file_, other.file_);
    std::swap(path_, other.path_);
    return *this;
}

MemoryFile::~MemoryFile() {
    if (file_ >= 0) ::close(file_);
}

Result<MemoryFile> MemoryFile::make() {
    const int file = ::memfd_create("pliant", MFD_CLOEXEC);
    if (file < 0) return failure("no room for a file in memory: {}", std::strerror(errno));
    return MemoryFile(file);
}

}  // namespace pliant::rehearse
