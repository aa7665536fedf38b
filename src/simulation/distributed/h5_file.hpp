// HDF5 files that all ranks write and read together.
#pragma once

#include <hdf5.h>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "simulation/distributed/ranks.hpp"

namespace pliant::sim::distributed {

/// Rows of a table that this rank has, of `total` rows.
struct Rows {
    int total = 0, first = 0, count = 0;
};

/// All functions are collective, unless one rank writes the file alone. Errors are the same on all ranks; errors of
/// writing are returned by close().
class H5File {
public:
    /// Replaces an existing file. `ranks`: null for a file that this rank writes alone.
    [[nodiscard]] static Result<H5File> create(const Ranks* ranks, const std::filesystem::path& path);
    [[nodiscard]] static Result<H5File> open(const Ranks& ranks, const std::filesystem::path& path);
    H5File(H5File&& other) noexcept;
    H5File& operator=(H5File&&) = delete;
    ~H5File();

    /// A table (total, width), or a list (total) if width is 1.
    void write(const std::string& name, Rows rows, int width, std::span<const double> values);
    void write(const std::string& name, Rows rows, int width, std::span<const int> values);
    [[nodiscard]] Result<std::vector<double>> read(const std::string& name, Rows rows, int width) const;
    /// Root's bytes.
    void write_bytes(const std::string& name, std::string bytes);
    [[nodiscard]] Result<std::string> read_bytes(const std::string& name) const;
    /// Afterwards the file is complete, or an error says why not.
    [[nodiscard]] Status close();

private:
    H5File(const Ranks* ranks, std::filesystem::path path, hid_t file);
    [[nodiscard]] Status agree(bool good, const char* what) const;
    void write(const std::string& name, hid_t type, Rows rows, int width, const void* values);

    const Ranks* ranks_;
    std::filesystem::path path_;
    hid_t file_;
    bool written_ = true;  ///< everything so far succeeded
};

}  // namespace pliant::sim::distributed
