// Zip files: written reproducibly and atomically, read with limits. Reading uses libzip.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "base/core/error.hpp"

namespace pliant {

/// Writes entries as they come; memory holds one record per entry. Zip64 if there are many.
class ZipWriter {
public:
    /// Writes `PATH.partial`, which close() renames. Errors: as of replaceable_file() in base/core/files.hpp, the disk.
    [[nodiscard]] static Result<ZipWriter> create(const std::filesystem::path& path);
    ZipWriter(ZipWriter&&) noexcept;
    ZipWriter& operator=(ZipWriter&&) noexcept;
    ~ZipWriter();  ///< without close() nothing is left behind

    enum class Method { store, deflate };
    /// Every entry gets the same date, so that equal calls give equal bytes. Errors: a duplicate name or one of more
    /// than 65535 bytes, an entry of 4 GB or more, the disk.
    [[nodiscard]] Status add(const std::string& name, std::string_view bytes, Method method);
    [[nodiscard]] Status close();

private:
    struct State;
    explicit ZipWriter(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

class ZipReader {
public:
    /// Errors: missing; not a regular file; not a zip archive; libzip is not installed.
    [[nodiscard]] static Result<ZipReader> open(const std::filesystem::path& path);
    ZipReader(ZipReader&&) noexcept;
    ZipReader& operator=(ZipReader&&) noexcept;
    ~ZipReader();

    [[nodiscard]] std::uint64_t entry_count() const;
    [[nodiscard]] std::string name(std::uint64_t index) const;
    [[nodiscard]] bool has(const std::string& name) const;
    /// The whole entry. Errors: missing; larger than `limit_bytes`; a size that its compressed bytes cannot have; a
    /// method other than stored and deflated; encrypted; a wrong checksum.
    [[nodiscard]] Result<std::string> read(const std::string& name, std::uint64_t limit_bytes) const;
    /// The first `count` bytes, or fewer if the entry is shorter. Errors as above, except the checksum.
    [[nodiscard]] Result<std::string> read_head(const std::string& name, std::uint64_t count) const;

private:
    struct State;
    explicit ZipReader(std::unique_ptr<State> state);
    [[nodiscard]] Result<std::uint64_t> checked_size(const std::string& name) const;
    [[nodiscard]] Result<std::string> read_bytes(const std::string& name, std::uint64_t count, bool whole) const;
    std::unique_ptr<State> state_;
};

}  // namespace pliant
