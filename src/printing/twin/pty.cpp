#include "printing/twin/pty.hpp"

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

namespace pliant::twin {
namespace {

Status put_link(const std::filesystem::path& link, const std::string& device) {
    std::error_code error;
    if (std::filesystem::is_symlink(link, error)) std::filesystem::remove(link, error);
    std::filesystem::create_symlink(device, link, error);
    return error ? Status(input_error("{}: {}; give a name that is free", link.string(), error.message())) : Status{};
}

}  // namespace

Pty::Pty(int file, int other_end, std::string device, std::filesystem::path link)
    : file_(file), other_end_(other_end), device_(std::move(device)), link_(std::move(link)) {}

Pty::Pty(Pty&& other) noexcept
    : file_(std::exchange(other.file_, -1)),
      other_end_(std::exchange(other.other_end_, -1)),
      device_(std::move(other.device_)),
      link_(std::exchange(other.link_, {})) {}

Pty::~Pty() {
    if (file_ >= 0) ::close(file_);
    if (other_end_ >= 0) ::close(other_end_);
    std::error_code ignored;
    if (!link_.empty()) std::filesystem::remove(link_, ignored);
}

Result<Pty> Pty::open(const std::filesystem::path& link) {
    const int file = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (file < 0 || ::grantpt(file) != 0 || ::unlockpt(file) != 0) {
        if (file >= 0) ::close(file);
        return failure("no pseudo-terminal: {}", std::strerror(errno));
    }
    std::array<char, 128> name{};
    const bool named = ::ptsname_r(file, name.data(), name.size()) == 0;
    const int other_end = named ? ::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC) : -1;
    Pty pty(file, other_end, name.data(), {});
    termios settings{};
    if (other_end < 0 || ::tcgetattr(other_end, &settings) != 0) {
        return failure("no pseudo-terminal: {}", std::strerror(errno));
    }
    ::cfmakeraw(&settings);
    ::tcsetattr(other_end, TCSANOW, &settings);
    if (!link.empty()) {
        if (Status status = put_link(link, pty.device_); !status) return tl::unexpected(status.error());
        pty.link_ = link;
    }
    return pty;
}

Result<std::string> Pty::read(double timeout_s) {
    pollfd wait{file_, POLLIN, 0};
    const int timeout_ms = static_cast<int>(std::clamp(timeout_s, 0.0, 3600.0) * 1000);
    if (::poll(&wait, 1, timeout_ms) <= 0) return std::string();
    std::array<char, 4096> bytes;
    const ssize_t got = ::read(file_, bytes.data(), bytes.size());
    if (got > 0) return std::string(bytes.data(), static_cast<std::size_t>(got));
    if (got < 0 && errno != EAGAIN && errno != EINTR && errno != EIO) {
        return failure("{}: {}", device_, std::strerror(errno));
    }
    return std::string();
}

void Pty::write(std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t put = ::write(file_, bytes.data(), bytes.size());
        if (put <= 0) return;
        bytes.remove_prefix(static_cast<std::size_t>(put));
    }
}

}  // namespace pliant::twin
