#include "base/core/files.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <optional>
#include <system_error>
#include <thread>

#include "base/core/letters.hpp"

namespace pliant {
namespace fs = std::filesystem;
using namespace std::chrono_literals;

namespace {

template <class... Args>
tl::unexpected<Error> failure_at(std::string file, fmt::format_string<Args...> text, Args&&... args) {
    return tl::unexpected(
        error_of(Cause::failed, {{std::move(file), 0, "", fmt::format(text, std::forward<Args>(args)...)}}));
}

tl::unexpected<Error> no_name() {
    return input_error("the name of a file is empty");
}

/// For a path whose kind the system does not tell, as of one in a folder that may not be read.
tl::unexpected<Error> unknown_place(const fs::path& path, const std::error_code& code) {
    return input_error_at(path.string(), 0, "{}", code.message());
}

}  // namespace

std::string lower_extension(const fs::path& path) {
    return lower_case(path.extension().string());
}

Result<std::string> read_file(const fs::path& path, std::uintmax_t limit_bytes) {
    if (path.empty()) return no_name();
    std::error_code code;
    const fs::file_status status = fs::status(path, code);
    if (status.type() == fs::file_type::none) return unknown_place(path, code);
    if (!fs::exists(status)) return input_error_at(path.string(), 0, "no such file");
    if (fs::is_directory(status)) return input_error_at(path.string(), 0, "is a folder, a file is needed");
    if (!fs::is_regular_file(status)) return input_error_at(path.string(), 0, "is not a regular file");
    const std::uintmax_t size = fs::file_size(path, code);
    if (code) return input_error_at(path.string(), 0, "{}", code.message());
    if (size > limit_bytes)
        return input_error_at(path.string(), 0, "{} bytes, more than the {} allowed", size, limit_bytes);
    std::ifstream in(path, std::ios::binary);
    std::string bytes(static_cast<std::size_t>(size), '\0');
    if (!in || !in.read(bytes.data(), static_cast<std::streamsize>(size))) {
        return input_error_at(path.string(), 0, "cannot be read: {}", std::strerror(errno));
    }
    return bytes;
}

namespace {

/// A name in /dev, /dev/fd or /proc, which is a way to an open file (/dev/stdout). What lies deeper in /dev, as in
/// /dev/shm, is a file as any other.
bool is_way_to_open_file(const fs::path& path) {
    std::error_code code;
    const fs::path absolute = fs::absolute(path, code).lexically_normal(), folder = absolute.parent_path();
    return folder == "/dev" || folder == "/dev/fd" || absolute.string().starts_with("/proc/");
}

/// Follows the links of `path` by hand: what /dev/stdout leads to may have no name of its own.
bool leads_to_open_file(fs::path path) {
    constexpr int most_links = 40;  // as the system's own limit
    std::error_code code;
    for (int k = 0; k < most_links; ++k) {
        if (is_way_to_open_file(path)) return true;
        if (!fs::is_symlink(fs::symlink_status(path, code))) return false;
        path = path.parent_path() / fs::read_symlink(path, code);
    }
    return false;
}

/// A device, a pipe, a socket or a way to an open file: what must not be replaced.
bool is_special(const fs::path& path, fs::file_type type) {
    if (type != fs::file_type::not_found && type != fs::file_type::regular && type != fs::file_type::directory)
        return true;
    return is_way_to_open_file(path);
}

/// What is special and can be written to. A pipe or socket with a name of its own cannot: opening it would wait until
/// somebody reads, perhaps for ever.
bool is_written_directly(const fs::path& path, fs::file_type type) {
    if (type == fs::file_type::directory || !is_special(path, type)) return false;
    return type == fs::file_type::character || type == fs::file_type::block || leads_to_open_file(path);
}

/// `shown`: name for the error.
Status write_through(const fs::path& path, std::string_view bytes, const fs::path& shown) {
    std::ofstream out(path, std::ios::binary | std::ios::trunc);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.flush();
    if (!out) return failure_at(shown.string(), "cannot be written: {}", std::strerror(errno));
    return {};
}

}  // namespace

Result<fs::path> replaceable_file(const fs::path& path) {
    std::error_code code;
    const fs::file_type type = fs::status(path, code).type();
    if (type == fs::file_type::directory) return input_error_at(path.string(), 0, "is a folder, a file is needed");
    if (is_special(path, type)) return input_error_at(path.string(), 0, "is not a regular file, and is not replaced");
    if (type == fs::file_type::not_found || !fs::is_symlink(fs::symlink_status(path, code))) return path;
    fs::path target = fs::canonical(path, code);
    if (code) return failure_at(path.string(), "{}", code.message());
    return target;
}

namespace {

constexpr const char* aside_ending = ".partial";
constexpr const char* old_ending = ".replaced";  // not ".old", which may be somebody's own copy
constexpr const char* begun_name = ".begun";     // in a folder that has not got its name yet

/// An error for a path that begins at the current folder, if that has been deleted.
Status check_current_folder(const fs::path& path) {
    std::error_code code;
    if (path.is_absolute()) return {};
    if (fs::current_path(code).empty() || code)
        return input_error("{}: the current folder no longer exists; change to another, or name a path from /",
                           path.string());
    return {};
}

/// An error if a file or folder `made` in this folder cannot be: it is no folder, is read-only, or the name is too
/// long, with an ending.
Status check_parent(const fs::path& folder, const fs::path& made, std::string_view ending) {
    std::error_code code;
    if (!fs::is_directory(folder, code))
        return input_error_at(made.string(), 0, "{} is a file, a folder is needed", folder.string());
    if (::access(folder.c_str(), W_OK | X_OK) != 0)
        return input_error_at(made.string(), 0, "cannot be made in {}: {}", folder.string(), std::strerror(errno));
    const long longest = ::pathconf(folder.c_str(), _PC_NAME_MAX);
    const auto room = static_cast<long>(ending.size());
    if (longest > 0 && static_cast<long>(made.filename().string().size()) + room > longest)
        return input_error_at(made.string(), 0, "the name is too long");
    return {};
}

fs::path absolute_place(const fs::path& path) {
    std::error_code code;
    fs::path place = fs::absolute(path, code).lexically_normal();
    return place.has_filename() ? place : place.parent_path();
}

/// Its links followed as far as it is there: a folder is renamed where it is, and the links to it stay.
fs::path real_place(const fs::path& path) {
    std::error_code code;
    fs::path place = fs::weakly_canonical(fs::absolute(path, code), code);
    if (code) return absolute_place(path);
    return place.has_filename() ? place : place.parent_path();
}

/// A folder that cannot be renamed, since something is mounted on it.
bool is_mount_point(const fs::path& folder) {
#ifdef STATX_ATTR_MOUNT_ROOT
    struct statx what {};
    if (::statx(AT_FDCWD, folder.c_str(), 0, STATX_TYPE, &what) == 0 &&
        (what.stx_attributes_mask & STATX_ATTR_MOUNT_ROOT) != 0)
        return (what.stx_attributes & STATX_ATTR_MOUNT_ROOT) != 0;
#endif
    struct stat own {
    }, parent{};  // an older kernel does not tell a folder that is mounted on another of the same file system
    return ::stat(folder.c_str(), &own) == 0 && ::stat(folder.parent_path().c_str(), &parent) == 0 &&
           own.st_dev != parent.st_dev;
}

bool is_there(const FileHandle& open, const fs::path& path) {
    struct stat one {
    }, other{};
    return ::fstat(open.number(), &one) == 0 && ::stat(path.c_str(), &other) == 0 && one.st_ino == other.st_ino &&
           one.st_dev == other.st_dev;
}

bool is_regular(const FileHandle& open) {
    struct stat what {};
    return ::fstat(open.number(), &what) == 0 && S_ISREG(what.st_mode);
}

/// Who may do what with a file; nothing: it is not there, or the system does not tell.
std::optional<mode_t> mode_of(const fs::path& file) {
    constexpr mode_t rights = 0777;  // whose it is may change, so not those to run as its owner
    struct stat what {};
    if (::stat(file.c_str(), &what) != 0) return std::nullopt;
    return what.st_mode & rights;
}

FileHandle opened(const fs::path& path, AsideKind kind) {
    constexpr mode_t usual = 0666;
    if (kind == AsideKind::file) return FileHandle(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, usual));
    return FileHandle(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
}

void empty(const FileHandle& open, const fs::path& path, AsideKind kind) {
    if (kind == AsideKind::file) return void(::ftruncate(open.number(), 0) == 0);
    std::error_code code;
    for (const fs::directory_entry& entry : fs::directory_iterator(path, code))
        if (entry.path().filename() != begun_name) fs::remove_all(entry.path(), code);
    constexpr mode_t usual = 0666;
    const FileHandle begun(::open((path / begun_name).c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, usual));
}

/// The first of `foreign` in the folder; empty if there is none.
std::string_view foreign_file(const fs::path& folder, const FolderMark& mark) {
    std::error_code code;
    for (const std::string_view file : mark.foreign)
        if (fs::exists(folder / file, code)) return file;
    return {};
}

}  // namespace

Status check_file_place(const fs::path& path) {
    if (path.empty()) return no_name();
    std::error_code code;
    const fs::file_type type = fs::status(path, code).type();
    if (type == fs::file_type::none) return unknown_place(path, code);
    if (is_written_directly(path, type)) return {};
    if (Status current = check_current_folder(path); !current) return current;
    const Result<fs::path> target = replaceable_file(path);
    if (!target) return tl::unexpected(target.error());
    const fs::path place = absolute_place(*target);
    if (!fs::exists(place.parent_path(), code))
        return input_error_at(path.string(), 0, "there is no folder {}", place.parent_path().string());
    return check_parent(place.parent_path(), place, aside_ending);
}

Status check_folder_place(const fs::path& path, const FolderMark& mark) {
    if (path.empty()) return input_error("the name of a folder is empty");
    std::error_code code;
    if (Status current = check_current_folder(path); !current) return current;
    const fs::path place = absolute_place(path), real = real_place(path), aside = aside_of(real);
    if (fs::exists(place, code) && !fs::is_directory(place, code))
        return input_error_at(path.string(), 0, "is a file, a folder is needed");
    if (const std::string_view file = foreign_file(real, mark); !file.empty())
        return input_error_at(path.string(), 0, "holds other results ({}); name another folder", file);
    if (!may_replace_folder(real, mark))
        return input_error_at(path.string(), 0, "holds other files (no {}); name an empty or new folder", mark.own);
    if (fs::exists(real, code) && is_mount_point(real))
        return input_error_at(path.string(), 0, "is a mount point, which cannot be replaced; name a folder in it: {}",
                              (path / "results").string());
    if (!may_replace_folder(aside, begun_name))
        return input_error_at(path.string(), 0, "cannot be written: {} is in the way; move it away, or delete it",
                              aside.string());
    fs::path made = place;
    while (made.has_relative_path() && !fs::exists(made.parent_path(), code)) made = made.parent_path();
    if (fs::is_symlink(fs::symlink_status(made, code)) && !fs::exists(made, code))
        return input_error("{}: {} is a link to {}, which does not exist; remove the link, or make that folder",
                           path.string(), made.string(), fs::read_symlink(made, code).string());
    if (place != made) {
        if (Status first = check_parent(made.parent_path(), place, old_ending); !first) return first;
        return check_parent(made.parent_path(), made, old_ending);
    }
    return check_parent(real.parent_path(), real, old_ending);
}

Status check_outside(const fs::path& input, const fs::path& folder) {
    std::error_code code;
    if (input.empty() || !fs::exists(input, code) || !fs::is_directory(folder, code)) return {};
    const fs::path inside = real_place(folder), place = absolute_place(input);
    const auto lies_inside = [&](const fs::path& file) {
        return std::mismatch(inside.begin(), inside.end(), file.begin(), file.end()).first == inside.end();
    };
    if (!lies_inside(real_place(place.parent_path())) && !lies_inside(real_place(input))) return {};
    return input_error_at(input.string(), 0,
                          "lies in {}, which the results would replace; name another folder, or move the file",
                          folder.string());
}

fs::path beside_folder(const fs::path& folder, std::string_view ending) {
    fs::path place = folder;
    while (!place.has_filename() && place.has_relative_path()) place = place.parent_path();
    if (place.filename() == "." || place.filename() == "..") place = absolute_place(place);
    place += ending;
    return place;
}

fs::path aside_of(const fs::path& target) {
    return target.string() + aside_ending;
}

Result<FileHandle> open_aside(const fs::path& aside, AsideKind kind, const fs::path& target,
                              std::chrono::milliseconds patience) {
    constexpr auto pause = 20ms;
    const auto refuse = [&](const char* why) { return failure_at(target.string(), "cannot be written: {}", why); };
    for (std::chrono::milliseconds waited{}; waited <= patience; waited += pause) {
        std::error_code code;
        if (kind == AsideKind::folder) fs::create_directories(aside, code);
        if (code) return refuse(code.message().c_str());
        FileHandle open = opened(aside, kind);
        if (open.is_open() && kind == AsideKind::file && !is_regular(open))
            return refuse((aside.filename().string() + " is in the way, which is not a regular file").c_str());
        // A folder may have been renamed just now, by the program that had it.
        if (!open.is_open() && (kind == AsideKind::file || errno != ENOENT)) return refuse(std::strerror(errno));
        const bool is_free = open.is_open() && ::flock(open.number(), LOCK_EX | LOCK_NB) == 0;
        const bool has_locks = is_free || errno == EWOULDBLOCK || errno == ENOENT;  // some file systems have none
        if ((is_free && is_there(open, aside)) || !has_locks) {
            if (kind == AsideKind::folder && !may_replace_folder(aside, begun_name))
                return refuse((aside.filename().string() + " is in the way").c_str());
            empty(open, aside, kind);
            return open;
        }
        if (waited + pause <= patience) std::this_thread::sleep_for(pause);
    }
    return refuse("another program is writing it; wait for it, or choose another name");
}

Status write_file(const fs::path& path, std::string_view bytes) {
    if (path.empty()) return no_name();
    std::error_code code;
    if (is_written_directly(path, fs::status(path, code).type())) return write_through(path, bytes, path);
    const Result<fs::path> target = replaceable_file(path);
    if (!target) return tl::unexpected(target.error());
    const fs::path aside = aside_of(*target);
    const Result<FileHandle> mine = open_aside(aside, AsideKind::file, path, 30s);
    if (!mine) return tl::unexpected(mine.error());
    // Nobody who may not read the file that it replaces gets to read this one, not even while it is written.
    const std::optional<mode_t> mode = mode_of(*target);
    if (mode) (void)::fchmod(mine->number(), *mode | S_IRUSR | S_IWUSR);
    Status status = write_through(aside, bytes, path);
    if (status) {
        fs::rename(aside, *target, code);
        if (code) status = failure_at(path.string(), "cannot be written: {}", code.message());
        // Only now: a file that may not be written would be in the way of the next one, if this process were killed.
        if (!code && mode) (void)::fchmod(mine->number(), *mode);
    }
    if (!status) fs::remove(aside, code);
    return status;
}

bool may_replace_folder(const fs::path& folder, const FolderMark& mark) {
    std::error_code code;
    if (!fs::exists(folder, code)) return true;
    if (!fs::is_directory(folder, code)) return false;
    if (fs::is_empty(folder, code)) return true;
    return fs::exists(folder / mark.own, code) && foreign_file(folder, mark).empty();
}

namespace {

/// `wanted`, or with a number a name that nothing has: what is there under this name may be somebody's own.
fs::path free_name(const fs::path& wanted) {
    std::error_code code;
    fs::path name = wanted;
    for (int k = 2; fs::exists(fs::symlink_status(name, code)); ++k) name = fmt::format("{}{}", wanted.string(), k);
    return name;
}

/// The old folder is deleted last, and put back if the new one cannot take its place.
Status put_in_place(const fs::path& fresh, const fs::path& target) {
    const fs::path old = free_name(target.string() + old_ending);
    std::error_code code, ignored;
    const bool replaces = fs::exists(target, ignored);
    if (replaces) fs::rename(target, old, code);
    if (!code) {
        fs::rename(fresh, target, code);
        if (code && replaces) fs::rename(old, target, ignored);
    }
    fs::remove((code ? fresh : target) / begun_name, ignored);
    if (code)
        return failure_at(target.string(), "cannot be replaced: {}; the new results are in {}", code.message(),
                          fresh.string());
    if (replaces) fs::remove_all(old, ignored);
    return {};
}

}  // namespace

Status write_folder(const fs::path& folder, const FolderMark& mark,
                    const std::function<Status(const fs::path&)>& fill) {
    std::error_code code;
    const fs::path target = real_place(folder);
    if (Status place = check_folder_place(folder, mark); !place) return place;
    const fs::path aside = aside_of(target);
    const Result<FileHandle> mine = open_aside(aside, AsideKind::folder, folder, 30min);
    if (!mine) return tl::unexpected(mine.error());
    try {
        if (const Status filled = fill(aside); !filled) {
            fs::remove_all(aside, code);
            return filled;
        }
    } catch (...) {  // of the caller: nothing is left of what was begun
        fs::remove_all(aside, code);
        throw;
    }
    return put_in_place(aside, target);
}

}  // namespace pliant
