#include "simulation/run/position_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "base/core/file_handle.hpp"

namespace pliant::sim {
namespace {

/// An open, unnamed file; none if the system refuses.
FileHandle nameless_file() {
    std::error_code code;
    const std::filesystem::path folder = std::filesystem::temp_directory_path(code);
    if (code) return FileHandle();
    std::string name = (folder / "pliant_XXXXXX").string();
    FileHandle file(::mkostemp(name.data(), O_CLOEXEC));
    if (file.is_open()) ::unlink(name.c_str());
    return file;
}

}  // namespace

class PositionFile::Mapping {
public:
    Mapping(Vec3* begin, std::size_t bytes) : begin_(begin), bytes_(bytes) {}
    Mapping(const Mapping&) = delete;
    Mapping& operator=(const Mapping&) = delete;
    ~Mapping() { ::munmap(begin_, bytes_); }
    [[nodiscard]] Vec3* begin() const { return begin_; }

private:
    Vec3* begin_;
    std::size_t bytes_;
};

PositionFile::PositionFile(std::shared_ptr<Mapping> mapping, std::size_t nodes)
    : mapping_(std::move(mapping)), nodes_(nodes) {}

std::unique_ptr<PositionFile> PositionFile::make(std::size_t steps, std::size_t nodes) {
    const FileHandle file = nameless_file();
    const std::size_t bytes = steps * nodes * sizeof(Vec3);
    // Reserves all space now: a disk that is full later would crash the program.
    if (!file.is_open() || ::posix_fallocate(file.number(), 0, static_cast<off_t>(bytes)) != 0) return nullptr;
    void* begin = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file.number(), 0);
    if (begin == MAP_FAILED) return nullptr;
    auto mapping = std::make_shared<Mapping>(static_cast<Vec3*>(begin), bytes);
    return std::unique_ptr<PositionFile>(new PositionFile(std::move(mapping), nodes));
}

NodePositions PositionFile::keep(std::size_t step, std::span<const Vec3> points) {
    Vec3* const place = mapping_->begin() + step * nodes_;
    std::copy(points.begin(), points.end(), place);
    return {mapping_, {place, nodes_}};
}

}  // namespace pliant::sim
