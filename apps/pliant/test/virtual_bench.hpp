// Bench for tests of whole prints: a job in memory, printed on the virtual printer as by `pliant print --twin`.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "printing/host/script.hpp"
#include "printing/rehearse/virtual_print.hpp"
#include "printing/twin/inspect.hpp"
#include "printing/wire/link.hpp"

namespace pliant::app {

inline host::PrintJob print_job(const job::Manifest& job, const std::string& gcode, host::ImageSource images) {
    host::PrintJob ready;
    ready.name = job.name;
    ready.digest = host::job_digest(gcode);
    ready.gcode = gcode;
    ready.images = std::move(images);
    for (const job::Material& material : job.materials) {
        ready.materials.push_back(material.name);
        ready.exposures_s.push_back(material.exposure_s);
    }
    ready.layers = static_cast<int>(job.layers.size());
    return ready;
}

/// A completed print.
struct Printed {
    std::unique_ptr<rehearse::VirtualPrint> print;
    Status status;
    twin::Report report;

    /// `archived`: the images that the block is compared with.
    Printed(const machine::Printer& printer, const job::Manifest& job, host::PrintJob ready,
            const host::ImageSource& archived, rehearse::Options options = {})
        : print(rehearse::VirtualPrint::make(printer, std::move(ready), std::move(options)).value()) {
        Progress silent;
        status = print->print(silent);
        report = twin::inspect(print->twin(), job, twin::ImageSource(archived)).value();
    }
    /// Number of completed exposure pieces.
    [[nodiscard]] int lights() const { return static_cast<int>(print->lights().size()); }
};

/// A host without checks: sends the commands of a program, without exposures, until the machine refuses one.
inline Status send_unchecked(twin::Twin& twin, const std::string& gcode) {
    rehearse::TwinWire wire(twin);
    rehearse::TwinClock clock(twin);
    host::Link link(wire, clock);
    const host::Script script = host::read_script(gcode).value();
    Status status = link.connect();
    for (const auto& step : script.steps) {
        const auto* command = std::get_if<std::string>(&step);
        if (status && command != nullptr) status = link.send(*command);
    }
    return status ? link.fence() : status;
}

}  // namespace pliant::app
