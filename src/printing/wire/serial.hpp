// A serial port as a Wire. Any baud rate, including 250000.
#pragma once

#include <string>
#include <vector>

#include "base/core/file_handle.hpp"
#include "printing/wire/devices.hpp"

namespace pliant::host {

class SerialWire final : public Wire {
public:
    /// Opens a terminal device exclusively: raw, 8 data bits, no parity, no flow control. Opening a board such as the
    /// Mega 2560 for the first time after it was plugged in resets it; closing and reopening does not. Errors name the
    /// device and the system's message; a device that another host has open is refused.
    [[nodiscard]] static Result<SerialWire> open(const std::string& device, int baud_rate);

    SerialWire(SerialWire&& other) noexcept;
    SerialWire& operator=(SerialWire&& other) noexcept;
    ~SerialWire() override;

    /// Thread-safe: a short line is written in one piece.
    [[nodiscard]] Status write(std::string_view bytes) override;
    [[nodiscard]] Result<std::string> read(double timeout_s) override;
    /// By a pulse of DTR.
    [[nodiscard]] Status reset() override;

private:
    SerialWire(FileHandle file, std::string device) : file_(std::move(file)), device_(std::move(device)) {}
    FileHandle file_;
    std::string device_;
    std::string lock_file_;  ///< "": none was made
};

struct SerialPort {
    std::string device;  ///< "/dev/ttyACM0"
    std::string name;    ///< of the board or adapter, "" if unknown to the system
};

/// The serial ports with hardware behind them, sorted by name. `devices` is for tests.
[[nodiscard]] std::vector<SerialPort> serial_ports(const std::string& devices = "/sys/class/tty");

}  // namespace pliant::host
