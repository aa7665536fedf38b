#include "host/serial.hpp"

// termios2 lives in the kernel's header, which must not meet <termios.h>.
#include <asm/termbits.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

namespace pliant::host {
namespace {

constexpr int write_timeout_ms = 5000;

Status set_up(int file, int baud_rate) {
    struct termios2 settings {};
    if (ioctl(file, TCGETS2, &settings) != 0) return input_error("{}", std::strerror(errno));
    settings.c_iflag = IGNPAR;
    settings.c_oflag = 0;
    settings.c_lflag = 0;
    settings.c_cflag = CS8 | CREAD | CLOCAL | BOTHER | (BOTHER << IBSHIFT);
    settings.c_cc[VMIN] = 0;
    settings.c_cc[VTIME] = 0;
    settings.c_ospeed = settings.c_ispeed = static_cast<speed_t>(baud_rate);
    if (ioctl(file, TCSETS2, &settings) != 0) return input_error("{}", std::strerror(errno));
    if (ioctl(file, TIOCEXCL) != 0) return input_error("{}", std::strerror(errno));
    return {};
}

/// Whether the file is ready for `events` in time; an interrupted wait counts as not yet.
Result<bool> wait_for(int file, short events, int timeout_ms) {
    pollfd wait{file, events, 0};
    const int ready = poll(&wait, 1, timeout_ms);
    if (ready < 0 && errno != EINTR) return failure("{}", std::strerror(errno));
    if (ready <= 0) return false;
    if ((wait.revents & events) == 0) return failure("the device is gone");
    return true;
}

}  // namespace

Result<SerialWire> SerialWire::open(const std::string& device, int baud_rate) {
    const int file = ::open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (file < 0) return input_error("{}: {}", device, std::strerror(errno));
    SerialWire wire(file, device);
    if (Status status = set_up(file, baud_rate); !status) {
        return input_error("{}: not a serial port that can run at {} baud: {}", device, baud_rate,
                           status.error().message);
    }
    return wire;
}

SerialWire::SerialWire(SerialWire&& other) noexcept
    : file_(std::exchange(other.file_, -1)), device_(std::move(other.device_)) {}

SerialWire& SerialWire::operator=(SerialWire&& other) noexcept {
    std::swap(file_, other.file_);
    std::swap(device_, other.device_);
    return *this;
}

SerialWire::~SerialWire() {
    if (file_ >= 0) ::close(file_);
}

Status SerialWire::write(std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t sent = ::write(file_, bytes.data(), bytes.size());
        if (sent > 0) {
            bytes.remove_prefix(static_cast<std::size_t>(sent));
            continue;
        }
        if (sent < 0 && errno != EAGAIN && errno != EINTR) return failure("{}: {}", device_, std::strerror(errno));
        const auto ready = wait_for(file_, POLLOUT, write_timeout_ms);
        if (!ready) return failure("{}: {}", device_, ready.error().message);
        if (!*ready) return failure("{}: takes no more bytes", device_);
    }
    return {};
}

Result<std::string> SerialWire::read(double timeout_s) {
    const int timeout_ms = static_cast<int>(std::clamp(timeout_s, 0.0, 3600.0) * 1000);
    const auto ready = wait_for(file_, POLLIN, timeout_ms);
    if (!ready) return failure("{}: {}", device_, ready.error().message);
    if (!*ready) return std::string();
    std::array<char, 4096> bytes;
    const ssize_t got = ::read(file_, bytes.data(), bytes.size());
    if (got > 0) return std::string(bytes.data(), static_cast<std::size_t>(got));
    if (got < 0 && (errno == EAGAIN || errno == EINTR)) return std::string();
    return failure("{}: {}", device_, got == 0 ? "the device is gone" : std::strerror(errno));
}

}  // namespace pliant::host
