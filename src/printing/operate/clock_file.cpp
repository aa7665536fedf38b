#include "printing/operate/clock_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "base/core/file_handle.hpp"
#include "base/core/files.hpp"

namespace pliant::operate {
namespace {

constexpr std::size_t clock_bytes = sizeof(double);

}  // namespace

/// A file that was named by mistake is not overwritten. A new clock takes the place of an old one, which a host may
/// still have mapped: it must not shrink there.
Result<ClockFile> ClockFile::create(const std::filesystem::path& path) {
    std::error_code none;
    if (std::filesystem::exists(path, none)) {
        if (auto old = open(path); !old) return input_error("{}; give another name", old.error().message);
    }
    if (Status written = write_file(path, std::string(clock_bytes, '\0')); !written)
        return tl::unexpected(written.error());
    return open(path);
}

Result<ClockFile> ClockFile::open(const std::filesystem::path& path) {
    const FileHandle file(::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK));
    if (!file.is_open()) return input_error("{}: {}", path.string(), std::strerror(errno));
    struct stat status {};
    const bool is_clock =
        ::fstat(file.number(), &status) == 0 && S_ISREG(status.st_mode) && status.st_size == clock_bytes;
    void* memory =
        is_clock ? ::mmap(nullptr, clock_bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file.number(), 0) : MAP_FAILED;
    if (memory == MAP_FAILED) return input_error("{}: not the clock of a virtual printer", path.string());
    return ClockFile(static_cast<double*>(memory));
}

ClockFile::ClockFile(ClockFile&& other) noexcept : seconds_(std::exchange(other.seconds_, nullptr)) {}

ClockFile::~ClockFile() {
    if (seconds_ != nullptr) ::munmap(seconds_, clock_bytes);
}

void ClockFile::set(double seconds) const {
    std::atomic_ref(*seconds_).store(seconds, std::memory_order_release);
}

double ClockFile::now() const {
    return std::atomic_ref(*seconds_).load(std::memory_order_acquire);
}

void ClockFile::sleep(double seconds) {
    constexpr useconds_t look_every_us = 500;
    for (const double end = now() + seconds; now() < end;) ::usleep(look_every_us);
}

}  // namespace pliant::operate
