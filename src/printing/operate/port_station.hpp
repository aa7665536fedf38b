// The machine at a serial port with everything a print needs: wire, projector, clock, emergency line, and a guard that
// outlives the host. Used by both the command line and the web page.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "base/core/error.hpp"
#include "printing/host/control_types.hpp"
#include "printing/operate/clock_file.hpp"
#include "printing/operate/print_job.hpp"
#include "printing/operate/process_guard.hpp"
#include "printing/screen/image_ahead.hpp"
#include "printing/wire/emergency_line.hpp"
#include "printing/wire/scaled_time.hpp"
#include "printing/wire/steady_clock.hpp"

namespace pliant::operate {

struct PortOptions {
    std::string device;
    std::string projector;             ///< number of a display, or path of a folder
    double speed = 1;                  ///< speed-up factor of its clock: above 1 for virtual printers only
    std::filesystem::path clock_file;  ///< of a virtual printer; "": real time
    std::string emergency_line;        ///< as parsed by host::parse_emergency_line(); "": the printer file's
};

class PortStation {
public:
    /// Opens the projector (dark) and starts the guard beside the job's journal; the control opens the port. Images of
    /// `ready` are decoded ahead from then on: the station must outlive the control. Errors: a speed out of range, no
    /// such projector, no such clock, an emergency line that cannot be operated.
    [[nodiscard]] static Result<std::unique_ptr<PortStation>> open(PortOptions options, ReadyJob& ready);
    PortStation(const PortStation&) = delete;
    PortStation& operator=(const PortStation&) = delete;

    [[nodiscard]] host::ControlSetup setup(const machine::Printer& printer);

private:
    PortStation(PortOptions options, std::optional<ClockFile> file);
    [[nodiscard]] host::Clock& clock();

    PortOptions options_;
    std::optional<ClockFile> file_;
    host::SteadyClock steady_;
    host::ScaledClock scaled_;
    std::optional<ProcessGuard> guard_;
    std::unique_ptr<host::EmergencyLine> emergency_line_;  ///< null: none
    std::unique_ptr<host::Projector> projector_;
    std::unique_ptr<host::ImageAhead> ahead_;
};

/// What a control needs to print on `device`, a serial port or a pseudo-terminal.
[[nodiscard]] host::ControlSetup port_setup(const std::string& device, double speed, const machine::Printer& printer,
                                            host::Projector& projector, host::Clock& clock, host::Guard* guard);

}  // namespace pliant::operate
