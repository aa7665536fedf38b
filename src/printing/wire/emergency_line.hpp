// The hardware's emergency line: stops the machine without its controller's help (emergency_line of the printer file).
#pragma once

#include <memory>
#include <string_view>

#include "base/core/error.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::host {

class EmergencyLine {
public:
    virtual ~EmergencyLine() = default;
    /// Lets the machine run. Errors: the device is gone.
    [[nodiscard]] virtual Status release() = 0;
    /// Stops it. From any thread, at any time, any number of times.
    [[nodiscard]] virtual Status pull() = 0;
};

/// Opens the line and checks that it works; its state is then that of release(). Errors name the device. nullptr for a
/// machine that has none, or whose controller operates it by itself.
[[nodiscard]] Result<std::unique_ptr<EmergencyLine>> open_emergency_line(const machine::EmergencyLine& line);

/// "dtr:/dev/ttyUSB1", "rts:/dev/ttyUSB1", "file:/sys/class/gpio/gpio17/value", "file-low:..." ("0" stops), "none".
[[nodiscard]] Result<machine::EmergencyLine> parse_emergency_line(std::string_view text);

}  // namespace pliant::host
