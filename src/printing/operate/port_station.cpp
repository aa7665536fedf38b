#include "printing/operate/port_station.hpp"

#include <utility>

#include "printing/operate/picture_projector.hpp"
#include "printing/operate/programs.hpp"
#include "printing/screen/projector.hpp"
#include "printing/wire/serial.hpp"

namespace pliant::operate {
namespace {

/// A display or a folder with a process that times every exposure; for a virtual printer with its own clock a plain
/// folder.
Result<std::unique_ptr<host::Projector>> open_projector(const PortOptions& options, const machine::Printer& printer) {
    const bool real_time = options.speed == 1 && options.clock_file.empty();
    if (real_time) {
        host::ScreenOptions screen;
        screen.width_px = printer.projector.width_px;
        screen.height_px = printer.projector.height_px;
        screen.longest_light_s = printer.limits.exposure_s;
        auto projector = host::ScreenProjector::open(options.projector, screen);
        if (!projector) return tl::unexpected(projector.error());
        return std::make_unique<host::ScreenProjector>(std::move(*projector));
    }
    std::error_code error;
    if (!std::filesystem::is_directory(options.projector, error))
        return input_error("--projector {}: no such folder", options.projector);
    return std::make_unique<PictureProjector>(options.projector);
}

/// The one in the options, else that of the printer file.
Result<std::unique_ptr<host::EmergencyLine>> open_emergency_line(const PortOptions& options,
                                                                 const machine::Printer& printer) {
    if (options.emergency_line.empty()) return host::open_emergency_line(printer.emergency_line);
    return host::parse_emergency_line(options.emergency_line).and_then(host::open_emergency_line);
}

}  // namespace

PortStation::PortStation(PortOptions options, std::optional<ClockFile> file)
    : options_(std::move(options)), file_(std::move(file)), scaled_(steady_, options_.speed) {}

host::Clock& PortStation::clock() {
    if (file_) return *file_;
    return scaled_;
}

Result<std::unique_ptr<PortStation>> PortStation::open(PortOptions options, ReadyJob& ready) {
    if (Status status = host::check_speed(options.speed); !status) return tl::unexpected(status.error());
    std::optional<ClockFile> file;
    if (!options.clock_file.empty()) {
        auto opened = ClockFile::open(options.clock_file);
        if (!opened) return tl::unexpected(opened.error());
        file.emplace(std::move(*opened));
    }
    std::unique_ptr<PortStation> station(new PortStation(std::move(options), std::move(file)));
    const PortOptions& o = station->options_;
    // Start the guard first: it must not inherit what this program opens later.
    auto guard =
        ProcessGuard::start({ready.job.journal.string() + ".guard", std::filesystem::path(o.projector) / "shown.png",
                             o.speed, station->file_ ? &*station->file_ : nullptr});
    if (!guard) return tl::unexpected(guard.error());
    station->guard_.emplace(std::move(*guard));
    auto line = open_emergency_line(o, ready.printer);
    if (!line) return tl::unexpected(line.error());
    station->emergency_line_ = std::move(*line);
    auto projector = open_projector(o, ready.printer);
    if (!projector) return tl::unexpected(projector.error());
    station->projector_ = std::move(*projector);
    if (Status dark = station->projector_->black(); !dark) return tl::unexpected(dark.error());
    station->ahead_ =
        std::make_unique<host::ImageAhead>(std::move(ready.job.images), host::order_of_exposures(ready.job.gcode));
    ready.job.images = [ahead = station->ahead_.get()](int layer, int material) { return ahead->get(layer, material); };
    return station;
}

host::ControlSetup PortStation::setup(const machine::Printer& printer) {
    const double speed = file_ ? 1 : options_.speed;
    host::ControlSetup setup = port_setup(options_.device, speed, printer, *projector_, clock(), &*guard_);
    if (file_) {
        // In real time, a wait of 10 ms for an answer would prolong an exposure of a fast printer by seconds.
        setup.open_wire = [open = std::move(setup.open_wire),
                           &clock = *file_]() -> Result<std::unique_ptr<host::Wire>> {
            auto wire = open();
            if (!wire) return wire;
            return std::make_unique<host::ClockedWire>(std::move(*wire), clock);
        };
    }
    setup.emergency_line = emergency_line_.get();
    return setup;
}

host::ControlSetup port_setup(const std::string& device, double speed, const machine::Printer& printer,
                              host::Projector& projector, host::Clock& clock, host::Guard* guard) {
    host::ControlSetup setup{printer, {}, projector, clock, programs_of(printer), {}, nullptr, {}, guard};
    setup.open_wire = [device, baud = printer.controller.baud_rate, speed]() -> Result<std::unique_ptr<host::Wire>> {
        auto wire = host::SerialWire::open(device, baud);
        if (!wire) return tl::unexpected(wire.error());
        std::unique_ptr<host::Wire> port = std::make_unique<host::SerialWire>(std::move(*wire));
        if (speed == 1) return port;
        return std::make_unique<host::ScaledWire>(std::move(port), speed);
    };
    setup.link = link_options(printer.controller);
    return setup;
}

}  // namespace pliant::operate
