#include "base/zip/zip_file.hpp"

#include <algorithm>

#include "base/zip/zip_library.hpp"

namespace pliant {
namespace {

const ZipLibrary& libzip() {
    return ZipLibrary::instance();
}

struct Discard {
    void operator()(zip_t* archive) const { libzip().discard(archive); }
};
using Handle = std::unique_ptr<zip_t, Discard>;

std::string text_of(int code) {
    if (code == ZIP_ER_NOZIP) return "is no zip archive, or the end of it is missing: was it copied completely?";
    zip_error_t error;
    libzip().error_init_with_code(&error, code);
    std::string text = libzip().error_strerror(&error);
    libzip().error_fini(&error);
    return text;
}

constexpr std::uint64_t max_deflate_ratio = 1032;

}  // namespace

struct ZipReader::State {
    std::string path;
    Handle archive;
    std::uint64_t file_bytes;
};

ZipReader::ZipReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
ZipReader::ZipReader(ZipReader&&) noexcept = default;
ZipReader& ZipReader::operator=(ZipReader&&) noexcept = default;
ZipReader::~ZipReader() = default;

Result<ZipReader> ZipReader::open(const std::filesystem::path& path) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status)) return input_error("{}: no such file", path.string());
    if (!std::filesystem::is_regular_file(status)) return input_error("{}: is not a regular file", path.string());
    const std::uint64_t bytes = std::filesystem::file_size(path, error);
    if (!libzip().is_there()) return failure("{}: the library {} is not installed", path.string(), libzip().name());
    int code = 0;
    Handle archive(libzip().open(path.c_str(), ZIP_RDONLY, &code));
    if (!archive) return input_error("{}: {}", path.string(), text_of(code));
    return ZipReader(std::make_unique<State>(State{path.string(), std::move(archive), bytes}));
}

std::uint64_t ZipReader::entry_count() const {
    return static_cast<std::uint64_t>(libzip().get_num_entries(state_->archive.get(), 0));
}

std::string ZipReader::name(std::uint64_t index) const {
    const char* name = libzip().get_name(state_->archive.get(), index, ZIP_FL_ENC_GUESS);
    return name == nullptr ? std::string() : std::string(name);
}

bool ZipReader::has(const std::string& name) const {
    return libzip().name_locate(state_->archive.get(), name.c_str(), 0) >= 0;
}

/// The stated size of an entry, after checking that its compressed bytes could hold it.
Result<std::uint64_t> ZipReader::checked_size(const std::string& name) const {
    zip_stat_t stat;
    libzip().stat_init(&stat);
    if (libzip().stat(state_->archive.get(), name.c_str(), 0, &stat) != 0)
        return input_error("{}: has no entry '{}'", state_->path, name);
    constexpr zip_uint64_t needed =
        ZIP_STAT_SIZE | ZIP_STAT_COMP_SIZE | ZIP_STAT_COMP_METHOD | ZIP_STAT_ENCRYPTION_METHOD;
    if ((stat.valid & needed) != needed || stat.encryption_method != ZIP_EM_NONE ||
        (stat.comp_method != ZIP_CM_STORE && stat.comp_method != ZIP_CM_DEFLATE))
        return input_error("{}: {}: must be stored or deflated, and not encrypted", state_->path, name);
    const std::uint64_t most = stat.comp_method == ZIP_CM_STORE ? stat.comp_size : stat.comp_size * max_deflate_ratio;
    if (stat.comp_size > state_->file_bytes || stat.size > most)
        return input_error("{}: {}: claims {} bytes, more than the archive can hold", state_->path, name, stat.size);
    return stat.size;
}

Result<std::string> ZipReader::read_bytes(const std::string& name, std::uint64_t count, bool whole) const {
    const std::unique_ptr<zip_file_t, int (*)(zip_file_t*)> file(libzip().fopen(state_->archive.get(), name.c_str(), 0),
                                                                 libzip().fclose);
    if (!file) return input_error("{}: {}: {}", state_->path, name, libzip().strerror(state_->archive.get()));
    std::string bytes(count, '\0');
    std::uint64_t done = 0;
    while (done < count) {
        const zip_int64_t got = libzip().fread(file.get(), bytes.data() + done, count - done);
        if (got <= 0)
            return input_error("{}: {}: {}", state_->path, name,
                               got < 0 ? libzip().file_strerror(file.get()) : "is cut short");
        done += static_cast<std::uint64_t>(got);
    }
    // Reading past the end makes libzip verify the checksum.
    char beyond = 0;
    if (whole && libzip().fread(file.get(), &beyond, 1) != 0)
        return input_error("{}: {}: damaged (wrong checksum or length)", state_->path, name);
    return bytes;
}

Result<std::string> ZipReader::read(const std::string& name, std::uint64_t limit_bytes) const {
    const auto size = checked_size(name);
    if (!size) return tl::unexpected(size.error());
    if (*size > limit_bytes)
        return input_error("{}: {}: {} bytes, more than the {} allowed", state_->path, name, *size, limit_bytes);
    return read_bytes(name, *size, true);
}

Result<std::string> ZipReader::read_head(const std::string& name, std::uint64_t count) const {
    const auto size = checked_size(name);
    if (!size) return tl::unexpected(size.error());
    return read_bytes(name, std::min(*size, count), false);
}

}  // namespace pliant
