#include "printing/rehearse/memory_file.hpp"

#include <fmt/format.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstring>

namespace pliant::rehearse {

MemoryFile::MemoryFile(int file) : file_(file), path_(fmt::format("/proc/self/fd/{}", file)) {}

Result<MemoryFile> MemoryFile::make() {
    const int file = ::memfd_create("pliant", MFD_CLOEXEC);
    if (file < 0) return failure("no room for a file in memory: {}", std::strerror(errno));
    return MemoryFile(file);
}

}  // namespace pliant::rehearse
