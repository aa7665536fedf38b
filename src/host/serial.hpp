// A serial port as a Wire. Any baud rate, 250000 too.
#pragma once

#include <string>

#include "host/devices.hpp"

namespace pliant::host {

class SerialWire final : public Wire {
public:
    /// Opens a terminal device for itself: raw, 8 data bits, no parity, no flow control. Opening the port of a board
    /// such as the Mega 2560 resets it. An error names the device and what the system said.
    [[nodiscard]] static Result<SerialWire> open(const std::string& device, int baud_rate);

    SerialWire(SerialWire&& other) noexcept;
    SerialWire& operator=(SerialWire&& other) noexcept;
    ~SerialWire() override;

    [[nodiscard]] Status write(std::string_view bytes) override;
    [[nodiscard]] Result<std::string> read(double timeout_s) override;

private:
    SerialWire(int file, std::string device) : file_(file), device_(std::move(device)) {}
    int file_ = -1;
    std::string device_;
};

}  // namespace pliant::host
