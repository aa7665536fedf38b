#include "printing/wire/emergency_line.hpp"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "base/core/file_handle.hpp"

namespace pliant::host {
namespace {

using Signal = machine::EmergencyLine::Signal;

/// A file kept open, so that opening cannot fail when it is needed.
class Opened {
public:
    Opened(std::string device, int flags)
        : device_(std::move(device)), file_(::open(device_.c_str(), flags | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {}

    [[nodiscard]] bool good() const { return file_.is_open(); }
    [[nodiscard]] int file() const { return file_.number(); }
    [[nodiscard]] tl::unexpected<Error> error() const {
        return failure("emergency line {}: {}", device_, std::strerror(errno));
    }

private:
    std::string device_;
    FileHandle file_;
};

/// A control line of a serial port: high lets the machine run.
class PortLine final : public EmergencyLine {
public:
    PortLine(const std::string& device, bool rts) : port_(device, O_RDWR), bit_(rts ? TIOCM_RTS : TIOCM_DTR) {}

    /// The port keeps the state of the line when the program ends: a crash of the host is left to the journal.
    [[nodiscard]] Status open() {
        termios settings{};
        if (!port_.good() || ::tcgetattr(port_.file(), &settings) != 0) return port_.error();
        settings.c_cflag |= CLOCAL;
        settings.c_cflag &= ~static_cast<tcflag_t>(HUPCL | CRTSCTS);
        if (::tcsetattr(port_.file(), TCSANOW, &settings) != 0) return port_.error();
        return release();
    }
    Status release() override { return set(TIOCMBIS); }
    Status pull() override { return set(TIOCMBIC); }

private:
    [[nodiscard]] Status set(unsigned long request) {
        return ::ioctl(port_.file(), request, &bit_) == 0 ? Status{} : port_.error();
    }
    Opened port_;
    int bit_;
};

/// A file that takes "1" or "0".
class FileLine final : public EmergencyLine {
public:
    FileLine(const std::string& device, bool stop_high) : pin_(device, O_WRONLY), stop_high_(stop_high) {}

    [[nodiscard]] Status open() { return pin_.good() ? release() : pin_.error(); }
    Status release() override { return write(!stop_high_); }
    Status pull() override { return write(stop_high_); }

private:
    [[nodiscard]] Status write(bool high) {
        return ::pwrite(pin_.file(), high ? "1\n" : "0\n", 2, 0) == 2 ? Status{} : pin_.error();
    }
    Opened pin_;
    bool stop_high_;
};

template <class Line>
Result<std::unique_ptr<EmergencyLine>> opened(std::unique_ptr<Line> line) {
    if (Status status = line->open(); !status) return tl::unexpected(Error{Cause::input, status.error().message});
    return line;
}

}  // namespace

Result<std::unique_ptr<EmergencyLine>> open_emergency_line(const machine::EmergencyLine& line) {
    switch (line.signal) {
        case Signal::dtr:
        case Signal::rts:
            return opened(std::make_unique<PortLine>(line.device, line.signal == Signal::rts));
        case Signal::file:
            return opened(std::make_unique<FileLine>(line.device, line.stop_high));
        case Signal::none:
        case Signal::controller:
            break;
    }
    return std::unique_ptr<EmergencyLine>();
}

Result<machine::EmergencyLine> parse_emergency_line(std::string_view text) {
    machine::EmergencyLine line;
    if (text == "none") return line;
    const std::size_t colon = text.find(':');
    const std::string_view signal = text.substr(0, colon);
    line.signal = signal == "dtr"                            ? Signal::dtr
                  : signal == "rts"                          ? Signal::rts
                  : signal == "file" || signal == "file-low" ? Signal::file
                                                             : Signal::none;
    line.stop_high = signal != "file-low";
    if (colon != std::string_view::npos) line.device = text.substr(colon + 1);
    if (line.signal == Signal::none || line.device.empty())
        return input_error(
            "emergency line \"{}\": write dtr:PORT, rts:PORT, file:FILE (1 stops), file-low:FILE (0 stops) or none",
            text);
    return line;
}

}  // namespace pliant::host
