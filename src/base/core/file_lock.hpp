// Locks of files between processes.
#pragma once

#include "base/core/file_handle.hpp"

namespace pliant {

enum class LockOutcome {
    ours,   ///< until the handle is closed, or the process ends, however it dies
    taken,  ///< by another process, or by another handle of this one
    none,   ///< the file system has no locks; errno says why
};
/// Locks the whole file, which must be open for writing, without waiting.
[[nodiscard]] LockOutcome try_lock(const FileHandle& file);

}  // namespace pliant
