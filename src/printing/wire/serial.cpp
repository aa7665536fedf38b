#include "printing/wire/serial.hpp"

// termios2 is in the kernel's header, which conflicts with <termios.h>.
#include <asm/termbits.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <utility>

namespace pliant::host {
namespace {

constexpr int write_timeout_ms = 5000;
constexpr useconds_t reset_pulse_us = 250000;
constexpr unsigned first_pty_major = 136, last_pty_major = 143;  // UNIX98 pseudo-terminals

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
    (void)ioctl(file, TCFLSH, TCIFLUSH);  // discard what was sent while nobody listened
    return {};
}

/// Exclusive use: by flock against hosts that ask for it, by TIOCEXCL against all others. A pseudo-terminal would stay
/// exclusive after a host has died, because its machine keeps it open, too.
Status take_alone(int file) {
    if (::flock(file, LOCK_EX | LOCK_NB) != 0) return input_error("another host has it open");
    struct stat status {};
    const bool known = ::fstat(file, &status) == 0;
    const bool pty = known && major(status.st_rdev) >= first_pty_major && major(status.st_rdev) <= last_pty_major;
    if (!pty && ioctl(file, TIOCEXCL) != 0) return input_error("{}", std::strerror(errno));
    return {};
}

/// The lock file used by programs such as minicom and picocom: LCK..ttyUSB0 with the process number. One whose process
/// is gone is stale. "": there is no folder for it, or the device is of another kind.
Result<std::string> make_lock_file(const std::string& device) {
    std::error_code none;
    const std::filesystem::path real = std::filesystem::canonical(device, none);
    if (none || real.parent_path() != "/dev") return std::string();
    const std::string name = "/run/lock/LCK.." + real.filename().string();
    if (std::ifstream file(name); file) {
        int process = 0;
        if (file >> process && process > 0 && process != ::getpid() && (::kill(process, 0) == 0 || errno == EPERM))
            return input_error("process {} has locked it ({})", process, name);
        std::filesystem::remove(name, none);
    }
    std::FILE* file = std::fopen(name.c_str(), "wx");
    if (file == nullptr) return std::string();
    std::fprintf(file, "%10d\n", static_cast<int>(::getpid()));
    std::fclose(file);
    return name;
}

std::string first_line(const std::filesystem::path& path) {
    std::ifstream file(path);
    std::string line;
    std::getline(file, line);
    return line;
}

/// Whether the file is ready for `events` in time; an interrupted wait counts as not ready.
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
    SerialWire wire(FileHandle(file), device);
    if (::isatty(file) != 1) return input_error("{}: not a serial port", device);
    if (Status status = take_alone(file); !status) return input_error("{}: {}", device, status.error().message);
    auto lock_file = make_lock_file(device);
    if (!lock_file) return input_error("{}: {}", device, lock_file.error().message);
    wire.lock_file_ = std::move(*lock_file);
    if (Status status = set_up(file, baud_rate); !status) {
        return input_error("{}: not a serial port that can run at {} baud: {}", device, baud_rate,
                           status.error().message);
    }
    return wire;
}

SerialWire::SerialWire(SerialWire&& other) noexcept
    : file_(std::move(other.file_)),
      device_(std::move(other.device_)),
      lock_file_(std::exchange(other.lock_file_, {})) {}

SerialWire& SerialWire::operator=(SerialWire&& other) noexcept {
    file_ = std::move(other.file_);
    std::swap(device_, other.device_);
    std::swap(lock_file_, other.lock_file_);
    return *this;
}

SerialWire::~SerialWire() {
    std::error_code none;
    if (!lock_file_.empty()) std::filesystem::remove(lock_file_, none);
}

Status SerialWire::reset() {
    int dtr = TIOCM_DTR;
    if (ioctl(file_.number(), TIOCMBIC, &dtr) != 0)
        return failure("{}: cannot be reset: {}", device_, std::strerror(errno));
    ::usleep(reset_pulse_us);
    if (ioctl(file_.number(), TIOCMBIS, &dtr) != 0)
        return failure("{}: cannot be reset: {}", device_, std::strerror(errno));
    return {};
}

Status SerialWire::write(std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t sent = ::write(file_.number(), bytes.data(), bytes.size());
        if (sent > 0) {
            bytes.remove_prefix(static_cast<std::size_t>(sent));
            continue;
        }
        if (sent < 0 && errno != EAGAIN && errno != EINTR) return failure("{}: {}", device_, std::strerror(errno));
        const auto ready = wait_for(file_.number(), POLLOUT, write_timeout_ms);
        if (!ready) return failure("{}: {}", device_, ready.error().message);
        if (!*ready) return failure("{}: takes no more bytes", device_);
    }
    return {};
}

Result<std::string> SerialWire::read(double timeout_s) {
    const int timeout_ms = static_cast<int>(std::clamp(timeout_s, 0.0, 3600.0) * 1000);
    const auto ready = wait_for(file_.number(), POLLIN, timeout_ms);
    if (!ready) return failure("{}: {}", device_, ready.error().message);
    if (!*ready) return std::string();
    std::array<char, 4096> bytes;
    const ssize_t got = ::read(file_.number(), bytes.data(), bytes.size());
    if (got > 0) return std::string(bytes.data(), static_cast<std::size_t>(got));
    if (got < 0 && (errno == EAGAIN || errno == EINTR)) return std::string();
    return failure("{}: {}", device_, got == 0 ? "the device is gone" : std::strerror(errno));
}

std::vector<SerialPort> serial_ports(const std::string& devices) {
    std::vector<SerialPort> ports;
    std::error_code none;
    for (const auto& entry : std::filesystem::directory_iterator(devices, none)) {
        const std::filesystem::path device = entry.path() / "device";
        if (!std::filesystem::exists(device, none)) continue;
        // Mainboard ports are listed whether they exist or not: type 0 means that they do not.
        const std::string type = first_line(entry.path() / "type");
        if (type == "0") continue;
        SerialPort port{"/dev/" + entry.path().filename().string(), ""};
        // The name of a USB board is one or two folders above its interface.
        for (const char* up : {"..", "../.."}) {
            if (port.name.empty()) port.name = first_line(std::filesystem::canonical(device, none) / up / "product");
        }
        ports.push_back(std::move(port));
    }
    std::sort(ports.begin(), ports.end(), [](auto& a, auto& b) { return a.device < b.device; });
    return ports;
}

}  // namespace pliant::host
