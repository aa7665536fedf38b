#include "base/core/files.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

namespace pliant {
namespace fs = std::filesystem;

Result<std::string> read_file(const fs::path& path, std::uintmax_t limit_bytes) {
    std::error_code code;
    const fs::file_status status = fs::status(path, code);
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

/// A device or a pipe; or a name in /dev, /dev/fd or /proc, which is a way to an open file (/dev/stdout). What lies
/// deeper in /dev, as in /dev/shm, is a file as any other.
bool is_special(const fs::path& path, fs::file_type type) {
    if (type != fs::file_type::not_found && type != fs::file_type::regular && type != fs::file_type::directory)
        return true;
    std::error_code code;
    const fs::path absolute = fs::absolute(path, code).lexically_normal(), folder = absolute.parent_path();
    return folder == "/dev" || folder == "/dev/fd" || absolute.string().starts_with("/proc/");
}

/// `shown`: name for the error.
Status write_through(const fs::path& path, std::string_view bytes, const fs::path& shown) {
    std::ofstream out(path, std::ios::binary | std::ios::trunc);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.flush();
    if (!out) return failure("{}: cannot be written: {}", shown.string(), std::strerror(errno));
    return {};
}

}  // namespace

Result<fs::path> replaceable_file(const fs::path& path) {
    std::error_code code;
    const fs::file_type type = fs::status(path, code).type();
    if (type == fs::file_type::directory) return input_error_at(path.string(), 0, "is a folder, a file is needed");
    if (is_special(path, type)) return input_error("{}: is not a regular file, and is not replaced", path.string());
    if (type == fs::file_type::not_found || !fs::is_symlink(fs::symlink_status(path, code))) return path;
    fs::path target = fs::canonical(path, code);
    if (code) return failure("{}: {}", path.string(), code.message());
    return target;
}

Status write_file(const fs::path& path, std::string_view bytes) {
    std::error_code code;
    if (is_special(path, fs::status(path, code).type())) return write_through(path, bytes, path);
    const Result<fs::path> target = replaceable_file(path);
    if (!target) return tl::unexpected(target.error());
    const fs::path aside = target->string() + ".partial";
    Status status = write_through(aside, bytes, path);
    if (status) {
        fs::rename(aside, *target, code);
        if (code) status = failure("{}: cannot be written: {}", path.string(), code.message());
    }
    if (!status) fs::remove(aside, code);
    return status;
}

bool may_replace_folder(const fs::path& folder, std::string_view marker) {
    std::error_code code;
    if (!fs::exists(folder, code)) return true;
    return fs::is_directory(folder, code) && (fs::is_empty(folder, code) || fs::exists(folder / marker, code));
}

namespace {

/// The old folder is deleted last, and put back if the new one cannot take its place.
Status put_in_place(const fs::path& fresh, const fs::path& target) {
    const fs::path old = target.string() + ".replaced";  // not ".old", which may be somebody's own copy
    std::error_code code, ignored;
    const bool replaces = fs::exists(target, ignored);
    if (replaces) {
        fs::remove_all(old, ignored);
        fs::rename(target, old, code);
    }
    if (!code) {
        fs::rename(fresh, target, code);
        if (code && replaces) fs::rename(old, target, ignored);
    }
    if (code)
        return failure("{}: cannot be replaced: {}; the new results are in {}", target.string(), code.message(),
                       fresh.string());
    fs::remove_all(old, ignored);
    return {};
}

}  // namespace

Status write_folder(const fs::path& folder, std::string_view marker,
                    const std::function<Status(const fs::path&)>& fill) {
    std::error_code code;
    fs::path target = fs::absolute(folder, code).lexically_normal();
    if (!target.has_filename()) target = target.parent_path();
    if (!may_replace_folder(target, marker)) {
        if (!fs::is_directory(target, code)) return input_error("{}: is a file, a folder is needed", folder.string());
        return input_error("{}: holds other files (no {}); name an empty or new folder", folder.string(), marker);
    }
    const fs::path aside = target.string() + ".partial";
    fs::remove_all(aside, code);
    fs::create_directories(aside, code);
    if (code) return failure("{}: cannot be made: {}", aside.string(), code.message());
    if (const Status filled = fill(aside); !filled) {
        fs::remove_all(aside, code);
        return filled;
    }
    return put_in_place(aside, target);
}

}  // namespace pliant
