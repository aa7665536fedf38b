#include "printing/operate/clock_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <utility>

namespace pliant::operate {

Result<ClockFile> ClockFile::map(const std::filesystem::path& path, bool make) {
    const int file = ::open(path.c_str(), O_RDWR | O_CLOEXEC | (make ? O_CREAT | O_TRUNC : 0), 0644);
    if (file < 0) return input_error("{}: {}", path.string(), std::strerror(errno));
    struct stat status {};
    const bool sized =
        make ? ::ftruncate(file, sizeof(double)) == 0 : ::fstat(file, &status) == 0 && status.st_size == sizeof(double);
    void* memory = sized ? ::mmap(nullptr, sizeof(double), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0) : MAP_FAILED;
    ::close(file);
    if (memory == MAP_FAILED) return input_error("{}: not the clock of a virtual printer", path.string());
    return ClockFile(static_cast<double*>(memory));
}

Result<ClockFile> ClockFile::create(const std::filesystem::path& path) {
    return map(path, true);
}

Result<ClockFile> ClockFile::open(const std::filesystem::path& path) {
    return map(path, false);
}

ClockFile::ClockFile(ClockFile&& other) noexcept : seconds_(std::exchange(other.seconds_, nullptr)) {}

ClockFile::~ClockFile() {
    if (seconds_ != nullptr) ::munmap(seconds_, sizeof(double));
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
