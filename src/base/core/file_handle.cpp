#include "base/core/file_handle.hpp"

#include <unistd.h>

#include <cerrno>

namespace pliant {

void FileHandle::close() noexcept {
    if (!is_open()) return;
    const int before = errno;  // may belong to an error being reported
    ::close(std::exchange(number_, -1));
    errno = before;
}

}  // namespace pliant
