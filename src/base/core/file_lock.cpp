#include "base/core/file_lock.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

namespace pliant {

LockOutcome try_lock(const FileHandle& file) {
    struct flock whole {};
    whole.l_type = F_WRLCK;
    whole.l_whence = SEEK_SET;
    if (::fcntl(file.number(), F_OFD_SETLK, &whole) == 0) return LockOutcome::ours;
    return errno == EAGAIN || errno == EACCES ? LockOutcome::taken : LockOutcome::none;
}

}  // namespace pliant
