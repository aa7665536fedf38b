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

/// Whether a twin still serves a pseudo-terminal. That of a twin which has died is gone, or belongs to a terminal by
/// now, which is never as raw.
bool is_served(const std::filesystem::path& device) {
    const FileHandle file(::open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    termios settings{};
    if (!file.is_open() || ::tcgetattr(file.number(), &settings) != 0) return false;
    return (settings.c_lflag & (ICANON | ECHO | ISIG)) == 0 && (settings.c_oflag & OPOST) == 0;
}

/// A link that a twin has left behind may be replaced.
Status check_link(const std::filesystem::path& link) {
    std::error_code error;
    const std::filesystem::path device = std::filesystem::read_symlink(link, error);
    if (device.parent_path() != "/dev/pts")
        return input_error("{}: leads to {}, which is no pseudo-terminal; give a name that is free", link.string(),
                           device.string());
    if (is_served(device))
        return input_error("{}: leads to {}, which another twin serves; end it, or give a name that is free",
                           link.string(), device.string());
    return {};
}

Status put_link(const std::filesystem::path& link, const std::string& device) {
    std::error_code error;
    if (std::filesystem::is_symlink(link, error)) {
        if (Status status = check_link(link); !status) return status;
        std::filesystem::remove(link, error);
    }
    std::filesystem::create_symlink(device, link, error);
    return error ? Status(input_error("{}: {}; give a name that is free", link.string(), error.message())) : Status{};
}

}  // namespace

Pty::Pty(FileHandle file, FileHandle other_end, std::string device)
    : file_(std::move(file)), other_end_(std::move(other_end)), device_(std::move(device)) {}

Pty::Pty(Pty&& other) noexcept
    : file_(std::move(other.file_)),
      other_end_(std::move(other.other_end_)),
      device_(std::move(other.device_)),
      link_(std::exchange(other.link_, {})) {}

Pty::~Pty() {
    std::error_code none;
    if (!link_.empty() && std::filesystem::read_symlink(link_, none) == device_) std::filesystem::remove(link_, none);
}

Result<Pty> Pty::open(const std::filesystem::path& link) {
    FileHandle file(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    if (!file.is_open() || ::grantpt(file.number()) != 0 || ::unlockpt(file.number()) != 0)
        return failure("no pseudo-terminal: {}", std::strerror(errno));
    std::array<char, 128> name{};
    const bool named = ::ptsname_r(file.number(), name.data(), name.size()) == 0;
    FileHandle other_end(named ? ::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC) : -1);
    termios settings{};
    if (!other_end.is_open() || ::tcgetattr(other_end.number(), &settings) != 0)
        return failure("no pseudo-terminal: {}", std::strerror(errno));
    ::cfmakeraw(&settings);
    ::tcsetattr(other_end.number(), TCSANOW, &settings);
    Pty pty(std::move(file), std::move(other_end), name.data());
    if (!link.empty()) {
        if (Status status = put_link(link, pty.device_); !status) return tl::unexpected(status.error());
        pty.link_ = link;
    }
    return pty;
}

Result<std::string> Pty::read(double timeout_s) {
    pollfd wait{file_.number(), POLLIN, 0};
    const int timeout_ms = static_cast<int>(std::clamp(timeout_s, 0.0, 3600.0) * 1000);
    if (::poll(&wait, 1, timeout_ms) <= 0) return std::string();
    std::array<char, 4096> bytes;
    const ssize_t got = ::read(file_.number(), bytes.data(), bytes.size());
    if (got > 0) return std::string(bytes.data(), static_cast<std::size_t>(got));
    if (got < 0 && errno != EAGAIN && errno != EINTR && errno != EIO) {
        return failure("{}: {}", device_, std::strerror(errno));
    }
    return std::string();
}

void Pty::write(std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t put = ::write(file_.number(), bytes.data(), bytes.size());
        if (put <= 0) return;
        bytes.remove_prefix(static_cast<std::size_t>(put));
    }
}

}  // namespace pliant::twin
