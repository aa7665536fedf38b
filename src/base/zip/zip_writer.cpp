// Zip files according to PKWARE's APPNOTE 6.3.10: entries one after the other, then the directory.
#include <libdeflate.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <set>
#include <vector>

#include "base/core/files.hpp"
#include "base/zip/zip_file.hpp"

namespace pliant {
namespace {

constexpr std::uint32_t most32 = 0xFFFFFFFF;
constexpr std::uint16_t most16 = 0xFFFF, utf8_names = 1 << 11, first_of_january_1980 = (1 << 5) | 1;
constexpr std::uint16_t plain_version = 20, zip64_version = 45;
constexpr int deflate_level = 6;

/// Little-endian numbers.
class Bytes {
public:
    Bytes& two(std::uint64_t value) { return put(value, 2); }
    Bytes& four(std::uint64_t value) { return put(value, 4); }
    Bytes& eight(std::uint64_t value) { return put(value, 8); }
    Bytes& text(std::string_view text) {
        bytes_ += text;
        return *this;
    }
    [[nodiscard]] const std::string& str() const { return bytes_; }

private:
    Bytes& put(std::uint64_t value, int count) {
        for (int i = 0; i < count; ++i) bytes_.push_back(static_cast<char>(value >> (8 * i) & 0xFF));
        return *this;
    }
    std::string bytes_;
};

struct Entry {
    std::string name;
    std::uint64_t offset = 0;
    std::uint32_t checksum = 0, packed = 0, size = 0;
    std::uint16_t method = 0;
};

/// The part shared by local header and directory, from the flags to the lengths of name and extra field.
void describe(Bytes& out, const Entry& e, std::size_t extra) {
    out.two(utf8_names).two(e.method).two(0).two(first_of_january_1980);
    out.four(e.checksum).four(e.packed).four(e.size).two(e.name.size()).two(extra);
}

std::string local_header(const Entry& e) {
    Bytes out;
    out.four(0x04034B50).two(plain_version);
    describe(out, e, 0);
    return out.text(e.name).str();
}

std::string directory_entry(const Entry& e) {
    const bool far = e.offset >= most32;
    Bytes out, extra;
    if (far) extra.two(1).two(8).eight(e.offset);
    const std::uint16_t version = far ? zip64_version : plain_version;
    out.four(0x02014B50).two(version).two(version);
    describe(out, e, extra.str().size());
    out.two(0).two(0).two(0).four(0).four(far ? most32 : e.offset);
    return out.text(e.name).text(extra.str()).str();
}

std::string directory_end(std::uint64_t count, std::uint64_t size, std::uint64_t offset) {
    Bytes out;
    if (count >= most16 || offset >= most32 || size >= most32) {
        out.four(0x06064B50).eight(44).two(zip64_version).two(zip64_version).four(0).four(0);
        out.eight(count).eight(count).eight(size).eight(offset);
        out.four(0x07064B50).four(0).eight(offset + size).four(1);
    }
    const std::uint64_t said = std::min<std::uint64_t>(count, most16);
    out.four(0x06054B50).two(0).two(0).two(said).two(said);
    out.four(std::min<std::uint64_t>(size, most32)).four(std::min<std::uint64_t>(offset, most32)).two(0);
    return out.str();
}

struct Close {
    void operator()(std::FILE* file) const { (void)std::fclose(file); }
};
struct FreeCompressor {
    void operator()(libdeflate_compressor* c) const { libdeflate_free_compressor(c); }
};

}  // namespace

struct ZipWriter::State {
    std::filesystem::path path, target, aside;
    std::unique_ptr<std::FILE, Close> file;
    std::unique_ptr<libdeflate_compressor, FreeCompressor> compressor;
    std::vector<Entry> entries{};
    std::set<std::string> names{};
    std::uint64_t offset = 0;
    bool closed = false;

    State(std::filesystem::path name, std::filesystem::path replaced, std::filesystem::path partial, std::FILE* opened)
        : path(std::move(name)),
          target(std::move(replaced)),
          aside(std::move(partial)),
          file(opened),
          compressor(libdeflate_alloc_compressor(deflate_level)) {}
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() {
        file.reset();
        std::error_code ignored;
        if (!closed) std::filesystem::remove(aside, ignored);
    }

    [[nodiscard]] Status fail() const {
        return failure("{}: cannot be written: {}", path.string(), std::strerror(errno));
    }
    Status put(std::string_view bytes) {
        if (std::fwrite(bytes.data(), 1, bytes.size(), file.get()) != bytes.size()) return fail();
        offset += bytes.size();
        return {};
    }
    /// Empty if deflating does not make it smaller.
    [[nodiscard]] std::string deflated(std::string_view bytes) const {
        std::string packed(bytes.size(), '\0');
        packed.resize(
            libdeflate_deflate_compress(compressor.get(), bytes.data(), bytes.size(), packed.data(), packed.size()));
        return packed;
    }
};

ZipWriter::ZipWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
ZipWriter::ZipWriter(ZipWriter&&) noexcept = default;
ZipWriter& ZipWriter::operator=(ZipWriter&&) noexcept = default;
ZipWriter::~ZipWriter() = default;

Result<ZipWriter> ZipWriter::create(const std::filesystem::path& path) {
    const Result<std::filesystem::path> target = replaceable_file(path);
    if (!target) return tl::unexpected(target.error());
    const std::filesystem::path aside = aside_of(*target);
    Result<FileHandle> mine = open_aside(aside, AsideKind::file, path, std::chrono::milliseconds(0));
    if (!mine) return tl::unexpected(mine.error());
    std::FILE* file = ::fdopen(mine->number(), "wb");
    if (file == nullptr) return failure("{}: cannot be written: {}", path.string(), std::strerror(errno));
    (void)mine->release();
    return ZipWriter(std::make_unique<State>(path, *target, aside, file));
}

Status ZipWriter::add(const std::string& name, std::string_view bytes, Method method) {
    State& s = *state_;
    if (name.size() > most16 || bytes.size() >= most32)
        return input_error("{}: {}: is too large for a zip file", s.path.string(), name.substr(0, 200));
    if (!s.names.insert(name).second) return failure("{}: {}: comes twice", s.path.string(), name);
    const std::string packed = method == Method::deflate ? s.deflated(bytes) : std::string();
    const std::string_view kept = packed.empty() ? bytes : std::string_view(packed);
    s.entries.push_back({name, s.offset, libdeflate_crc32(0, bytes.data(), bytes.size()),
                         static_cast<std::uint32_t>(kept.size()), static_cast<std::uint32_t>(bytes.size()),
                         static_cast<std::uint16_t>(packed.empty() ? 0 : 8)});
    if (auto status = s.put(local_header(s.entries.back())); !status) return status;
    return s.put(kept);
}

Status ZipWriter::close() {
    State& s = *state_;
    const std::uint64_t begin = s.offset;
    for (const Entry& e : s.entries) {
        if (auto status = s.put(directory_entry(e)); !status) return status;
    }
    if (auto status = s.put(directory_end(s.entries.size(), s.offset - begin, begin)); !status) return status;
    if (std::fclose(s.file.release()) != 0) return s.fail();
    std::error_code code, ignored;
    const std::filesystem::file_status replaced = std::filesystem::status(s.target, ignored);
    std::filesystem::rename(s.aside, s.target, code);
    if (code) return failure("{}: cannot be written: {}", s.path.string(), code.message());
    constexpr auto rights = std::filesystem::perms::all;
    if (std::filesystem::exists(replaced))
        std::filesystem::permissions(s.target, replaced.permissions() & rights, ignored);
    s.closed = true;
    return {};
}

}  // namespace pliant
