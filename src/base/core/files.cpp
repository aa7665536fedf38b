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
    if (!fs::exists(status)) return input_error("{}: no such file", path.string());
    if (fs::is_directory(status)) return input_error("{}: is a folder, a file is needed", path.string());
    if (!fs::is_regular_file(status)) return input_error("{}: is not a regular file", path.string());
    const std::uintmax_t size = fs::file_size(path, code);
    if (code) return input_error("{}: {}", path.string(), code.message());
    if (size > limit_bytes)
        return input_error("{}: {} bytes, more than the {} allowed", path.string(), size, limit_bytes);
    std::ifstream in(path, std::ios::binary);
    std::string bytes(static_cast<std::size_t>(size), '\0');
    if (!in || !in.read(bytes.data(), static_cast<std::streamsize>(size))) {
        return input_error("{}: cannot be read: {}", path.string(), std::strerror(errno));
    }
    return bytes;
}

Status write_file(const fs::path& path, std::string_view bytes) {
    const fs::path aside = path.string() + ".partial";
    std::error_code code;
    {
        std::ofstream out(aside, std::ios::binary | std::ios::trunc);
        out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        out.flush();
        if (!out) {
            const std::string reason = std::strerror(errno);
            fs::remove(aside, code);
            return failure("{}: cannot be written: {}", path.string(), reason);
        }
    }
    fs::rename(aside, path, code);
    if (code) {
        const std::string reason = code.message();
        fs::remove(aside, code);
        return failure("{}: cannot be written: {}", path.string(), reason);
    }
    return {};
}

bool may_replace_folder(const fs::path& folder, std::string_view marker) {
    std::error_code code;
    if (!fs::exists(folder, code)) return true;
    return fs::is_directory(folder, code) && (fs::is_empty(folder, code) || fs::exists(folder / marker, code));
}

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
    fs::remove_all(target, code);
    fs::rename(aside, target, code);
    if (code) return failure("{}: cannot be written: {}", folder.string(), code.message());
    return {};
}

}  // namespace pliant
