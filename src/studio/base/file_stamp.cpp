#include "studio/base/file_stamp.hpp"

#include <sys/stat.h>

namespace pliant::studio {

std::optional<FileStamp> stamp_of(const std::filesystem::path& path) {
    struct stat found {};
    if (::stat(path.c_str(), &found) != 0) return std::nullopt;
    return FileStamp{static_cast<std::uintmax_t>(found.st_dev), static_cast<std::uintmax_t>(found.st_ino),
                     static_cast<std::uintmax_t>(found.st_size), found.st_mtim.tv_sec, found.st_mtim.tv_nsec};
}

Status check_unchanged(const std::filesystem::path& path, const std::optional<FileStamp>& stamp) {
    const std::optional<FileStamp> now = stamp_of(path);
    if (!now || now == stamp) return {};
    return failure("{} has changed since it was opened: open it again", path.filename().string());
}

}  // namespace pliant::studio
