#include "base/core/checkpoint_folder.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "base/core/file_lock.hpp"
#include "base/core/files.hpp"

namespace pliant {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr const char* lock_name = "lock";

/// True if a process that was killed may have left it: nothing but the lock.
bool has_only_lock(const fs::path& folder) {
    std::error_code code;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, code))
        if (entry.path().filename() != lock_name) return false;
    return !code;
}

bool may_take(const fs::path& folder, const std::string& mark) {
    return may_replace_folder(folder, std::string_view(mark)) || has_only_lock(folder);
}

bool is_named(const FileHandle& open, const fs::path& path) {
    struct stat one {
    }, other{};
    return ::fstat(open.number(), &one) == 0 && ::stat(path.c_str(), &other) == 0 && one.st_ino == other.st_ino &&
           one.st_dev == other.st_dev;
}

struct Attempt {
    FileHandle lock;     ///< open: it is ours
    bool taken = false;  ///< another process has it
    int error = 0;       ///< otherwise why it cannot be opened
};

Attempt attempt(const fs::path& folder) {
    const fs::path file = folder / lock_name;
    constexpr mode_t usual = 0666;
    for (;;) {
        FileHandle open(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, usual));
        if (!open.is_open()) return {FileHandle(), false, errno};
        const LockOutcome outcome = try_lock(open);
        if (outcome == LockOutcome::taken) return {FileHandle(), true, 0};
        // Otherwise the process that had the lock has deleted the folder meanwhile.
        if (outcome == LockOutcome::none || is_named(open, file)) return {std::move(open), false, 0};
    }
}

/// `makes`: makes the folder where it is not there, or no more.
Result<FileHandle> locked(const fs::path& folder, bool makes) {
    // A process that was killed holds its lock until its memory is freed.
    constexpr std::chrono::milliseconds patience = 1s, pause = 20ms;
    for (std::chrono::milliseconds waited{};; waited += pause) {
        std::error_code code;
        if (makes) fs::create_directories(folder, code);
        if (code) return failure("{}: cannot be made: {}", folder.string(), code.message());
        Attempt now = attempt(folder);
        if (now.lock.is_open()) return std::move(now.lock);
        const bool waits = waited < patience && (now.taken || (makes && now.error == ENOENT));
        if (now.taken && !waits)
            return input_error_at(folder.string(), 0,
                                  "another process is at work on this checkpoint; wait for it, or choose another "
                                  "folder for the results");
        if (!waits) return failure("{}: cannot be opened: {}", (folder / lock_name).string(), std::strerror(now.error));
        std::this_thread::sleep_for(pause);
    }
}

/// All but the lock; the mark goes last, so that the rest is known for a checkpoint until then.
std::error_code emptied(const fs::path& folder, const std::string& mark) {
    std::error_code code;
    std::vector<fs::path> old;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, code))
        if (entry.path().filename() != lock_name && entry.path().filename() != mark) old.push_back(entry.path());
    old.push_back(folder / mark);
    for (const fs::path& path : old)
        if (!code) fs::remove_all(path, code);
    return code;
}

/// Some file systems and devices cannot: then nothing can be done.
Status synced(const FileHandle& open, const fs::path& shown) {
    int done = ::fsync(open.number());
    while (done != 0 && errno == EINTR) done = ::fsync(open.number());
    if (done == 0 || errno == EINVAL || errno == ENOTSUP || errno == ENOSYS) return {};
    return failure("{}: cannot be written to the disk: {}", shown.string(), std::strerror(errno));
}

/// Which files are in a folder is on the disk only after this.
Status sync_names(const fs::path& folder) {
    const FileHandle open(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    return open.is_open() ? synced(open, folder) : Status{};  // a folder that may not be listed can be worked in
}

Status write_all(const FileHandle& open, std::string_view bytes, const fs::path& shown) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(open.number(), bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return failure("{}: cannot be written: {}", shown.string(), std::strerror(errno));
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    return {};
}

}  // namespace

Result<CheckpointFolder> CheckpointFolder::create(fs::path folder, std::string mark) {
    const auto foreign = [&] {
        return input_error_at(folder.string(), 0, "is there already, and is not a checkpoint; move it away");
    };
    if (!may_take(folder, mark)) return foreign();
    Result<FileHandle> lock = locked(folder, true);
    if (!lock) return tl::unexpected(lock.error());
    if (!may_take(folder, mark)) return foreign();
    if (const std::error_code code = emptied(folder, mark))
        return failure("{}: cannot be emptied: {}", folder.string(), code.message());
    if (Status status = sync_names(fs::absolute(folder).parent_path()); !status) return tl::unexpected(status.error());
    return CheckpointFolder(std::move(folder), std::move(mark), std::move(*lock));
}

Result<CheckpointFolder> CheckpointFolder::open(fs::path folder, std::string mark) {
    Result<FileHandle> lock = locked(folder, false);
    if (!lock) return tl::unexpected(lock.error());
    return CheckpointFolder(std::move(folder), std::move(mark), std::move(*lock));
}

Status CheckpointFolder::write(const std::string& name, std::string_view bytes) const {
    const fs::path file = path_ / name, aside = aside_of(file);
    constexpr mode_t usual = 0666;
    FileHandle open(::open(aside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, usual));
    if (!open.is_open()) return failure("{}: cannot be written: {}", file.string(), std::strerror(errno));
    Status status = write_all(open, bytes, file);
    if (status) status = synced(open, file);
    std::error_code code;
    if (status) fs::rename(aside, file, code);
    if (code) status = failure("{}: cannot be written: {}", file.string(), code.message());
    if (!status) fs::remove(aside, code);
    return status ? sync_names(path_) : status;
}

Status CheckpointFolder::sync(const std::string& name) const {
    const fs::path file = path_ / name;
    const FileHandle open(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
    if (!open.is_open()) return failure("{}: cannot be opened: {}", file.string(), std::strerror(errno));
    return synced(open, file);
}

Status CheckpointFolder::remove() const {
    std::error_code code;
    if (!fs::exists(path_, code) || !may_take(path_, mark_)) return {};
    Attempt taken;
    if (!lock_.is_open()) {
        taken = attempt(path_);
        if (taken.taken || taken.error == ENOENT) return {};
        if (taken.error != 0) return failure("{}: cannot be deleted: {}", path_.string(), std::strerror(taken.error));
    }
    code = emptied(path_, mark_);
    if (!code) fs::remove(path_ / lock_name, code);
    if (!code) fs::remove(path_, code);
    // Once the lock has no name another process may begin here.
    if (!code || code == std::errc::directory_not_empty) return {};
    return failure("{}: cannot be deleted: {}", path_.string(), code.message());
}

}  // namespace pliant
