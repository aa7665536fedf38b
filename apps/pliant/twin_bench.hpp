// A virtual printer as the devices of a running print: the host's wire ends in the twin, its projector lights the
// twin's resin, its clock is the twin's. Nothing takes wall time: waiting moves the virtual clock on.
//
//     TwinBench bench(printer);
//     host::print_job(gcode, images, bench.devices(), progress, record);
//     twin::inspect(bench.twin(), manifest, images);
#pragma once

#include "printing/host/print.hpp"
#include "printing/twin/twin.hpp"
#include "printing/wire/devices.hpp"

namespace pliant::app {

class TwinWire final : public host::Wire {
public:
    explicit TwinWire(twin::Twin& twin) : twin_(twin) {}
    [[nodiscard]] Status write(std::string_view bytes) override;
    /// Runs the virtual clock until the twin says something, at most for `timeout_s`.
    [[nodiscard]] Result<std::string> read(double timeout_s) override;

private:
    twin::Twin& twin_;
};

class TwinProjector final : public host::Projector {
public:
    explicit TwinProjector(twin::Twin& twin) : twin_(twin) {}
    [[nodiscard]] Status show(const job::Image& image) override;
    [[nodiscard]] Status black() override;

private:
    twin::Twin& twin_;
};

class TwinClock final : public host::Clock {
public:
    explicit TwinClock(twin::Twin& twin) : twin_(twin) {}
    [[nodiscard]] double now() const override { return twin_.now(); }
    void sleep(double seconds) override { twin_.advance_to(twin_.now() + seconds); }

private:
    twin::Twin& twin_;
};

/// A twin with all its devices. The vats hold what `printer` says: give it plan::filled_printer.
class TwinBench {
public:
    explicit TwinBench(const machine::Printer& printer, twin::Options options = {});

    [[nodiscard]] twin::Twin& twin() { return twin_; }
    [[nodiscard]] host::Devices devices() { return {wire_, projector_, clock_}; }

    TwinBench(const TwinBench&) = delete;
    TwinBench& operator=(const TwinBench&) = delete;

private:
    twin::Twin twin_;
    TwinWire wire_;
    TwinProjector projector_;
    TwinClock clock_;
};

}  // namespace pliant::app
