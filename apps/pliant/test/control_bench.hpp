// Test bench for controlled prints: a small job of two materials, a twin, a control that is served in the calling
// thread, and ways to kill a host midway.
#pragma once

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "base/core/test_folder.hpp"
#include "halves.hpp"
#include "printing/host/control.hpp"
#include "printing/host/journal.hpp"
#include "printing/operate/programs.hpp"
#include "printing/plan/plan.hpp"
#include "printing/rehearse/virtual_devices.hpp"
#include "printing/twin/inspect.hpp"

namespace pliant::app {

/// Thrown by the devices of a host that has been killed, so that nothing it does afterwards has an effect.
struct Killed {};

/// Counts the device operations of a host; at the n-th one it is killed.
struct Life {
    long deeds = 0;
    long dies_at = -1;
    bool dead = false;
    bool unplugged = false;  ///< the cable of the machine is unplugged
    int resets = 0;          ///< controller resets requested by the host
    std::function<void()> on_death;
    /// Called at every operation on the wire, to inject faults.
    std::function<void(long)> at_deed;
    /// Called whenever the host listens, to send requests.
    std::function<void()> at_look;

    bool act(bool on_wire = true) {
        if (dead) return false;
        ++deeds;
        if (at_deed && on_wire) at_deed(deeds);
        if (deeds != dies_at) return true;
        die();
    }

    [[noreturn]] void die() {
        dead = true;
        if (on_death) on_death();
        throw Killed();
    }
};

class MortalWire final : public host::Wire {
public:
    MortalWire(twin::Twin& twin, Life& life) : twin_(twin), wire_(twin), life_(life) {}
    [[nodiscard]] Status write(std::string_view bytes) override {
        if (life_.unplugged) return failure("the device is gone");
        if (!life_.act()) return {};
        return wire_.write(bytes);
    }
    [[nodiscard]] Result<std::string> read(double timeout_s) override {
        if (life_.dead) return std::string();
        if (life_.at_look) life_.at_look();
        if (life_.unplugged) return failure("the device is gone");
        auto said = wire_.read(timeout_s);
        if (said && !said->empty() && !life_.act()) return std::string();
        return said;
    }

    [[nodiscard]] Status reset() override {
        ++life_.resets;
        twin_.reset();
        return {};
    }

private:
    twin::Twin& twin_;
    rehearse::TwinWire wire_;
    Life& life_;
};

class MortalProjector final : public host::Projector {
public:
    MortalProjector(twin::Twin& twin, Life& life) : twin_(twin), life_(life) {}
    [[nodiscard]] Status show(const job::Image& image) override {
        if (!life_.act(false)) return {};
        twin_.light_on(image);
        lit = true;
        return {};
    }
    [[nodiscard]] Status black() override {
        if (!lit) return {};
        if (!life_.act(false)) return {};
        twin_.light_off();
        lit = false;
        return {};
    }
    bool lit = false;

private:
    twin::Twin& twin_;
    Life& life_;
};

struct ControlBench {
    int layers = 5;
    machine::Printer printer;
    job::Manifest job;
    std::string gcode;
    test::Folder folder{"control"};
    std::unique_ptr<twin::Twin> twin;
    std::unique_ptr<Life> life = std::make_unique<Life>();
    std::unique_ptr<rehearse::TwinGuard> guard;
    bool guarded = true;
    bool sync = false;
    host::LayerHook after_layer;
    std::function<void()> at_open;   ///< of the port
    std::vector<host::Given> ended;  ///< exposures, as reported by the host
    host::EmergencyLine* emergency_line = nullptr;
    std::vector<host::Refill> refills;
    std::unique_ptr<rehearse::TwinClock> clock;
    std::unique_ptr<MortalProjector> projector;
    std::unique_ptr<host::Control> control;
    std::string first_error;

    explicit ControlBench(twin::Options options = {}, const std::string& name = "tower", int layer_count = 5,
                          const std::function<void(machine::Printer&)>& change = {})
        : layers(layer_count) {
        printer = machine::load_printer(fmt::format("examples/printers/{}.toml", name)).value();
        if (change) change(printer);
        printer.projector.width_px = halves::width_px;
        printer.projector.height_px = halves::height_px;
        printer.projector.pixel_um = halves::pixel_um;
        make_job();
        twin = std::make_unique<twin::Twin>(printer, std::move(options));
        guard = std::make_unique<rehearse::TwinGuard>(*twin);
        new_host();
    }
    ~ControlBench() { control.reset(); }
    ControlBench(const ControlBench&) = delete;
    ControlBench& operator=(const ControlBench&) = delete;

    void make_job() {
        job = halves::job({layers, 2, 12, 0, printer.vats.front().resin, printer.vats.back().resin});
        auto planned = plan::make_plan(job, printer);
        REQUIRE_MESSAGE(planned, (planned ? "" : planned.error().message));
        const plan::Plan& plan = *planned;
        gcode = plan::write_gcode(plan, job, printer);
    }

    /// A new host that knows nothing but the journal. Whatever the previous one had open is closed, as the operating
    /// system would.
    void new_host() {
        control.reset();
        life = std::make_unique<Life>();
        clock = std::make_unique<rehearse::TwinClock>(*twin);
        projector = std::make_unique<MortalProjector>(*twin, *life);
        host::ControlSetup setup{printer,
                                 [this]() -> Result<std::unique_ptr<host::Wire>> {
                                     if (at_open) at_open();
                                     return std::make_unique<MortalWire>(*twin, *life);
                                 },
                                 *projector,
                                 *clock,
                                 operate::programs_of(printer),
                                 operate::link_options(printer.controller),
                                 emergency_line,
                                 [this](int layer) {
                                     if (after_layer) after_layer(layer);
                                 },
                                 guarded ? guard.get() : nullptr,
                                 [this](const host::Given& given) { ended.push_back(given); }};
        life->on_death = [this] {
            guard->host_died();
            twin->light_off();
        };
        control = std::make_unique<host::Control>(std::move(setup));
        host::PrintJob ready;
        ready.name = job.name;
        ready.digest = host::job_digest(gcode);
        ready.gcode = gcode;
        ready.images = halves::image;
        ready.materials = {"soft", "rigid"};
        ready.exposures_s = {job.materials[0].exposure_s, job.materials[1].exposure_s};
        ready.layers = layers;
        ready.refills = refills;
        ready.journal = folder.path() / "halves.zip.journal";
        ready.sync_journal = sync;
        const Status loaded = control->load(std::move(ready));
        REQUIRE_MESSAGE(loaded, (loaded ? "" : loaded.error().message));
        control->serve_until_idle();
    }

    /// True if the host was not killed before the end.
    bool start(const host::StartOptions& options = {}) {
        const Status started = control->start(options);
        REQUIRE_MESSAGE(started, (started ? "" : started.error().message));
        try {
            control->serve_until_idle();
        } catch (const Killed&) {
            return false;
        }
        if (first_error.empty()) first_error = last_error();
        return true;
    }
    [[nodiscard]] host::Snapshot snapshot() const { return control->snapshot(); }
    [[nodiscard]] std::string last_error() const {
        std::string text;
        for (const host::Event& event : control->events_since(0)) {
            if (event.kind == "error") text = event.text;
        }
        return text;
    }
    [[nodiscard]] twin::Report report() { return twin::inspect(*twin, job, twin::ImageSource(halves::image)).value(); }
    void must_be_whole() {
        const twin::Report r = report();
        CHECK_MESSAGE(r.passed, twin::report_text(r));
    }
    void must_finish(const host::StartOptions& options = {}) {
        start(options);
        INFO(last_error());
        CHECK(snapshot().finished);
        must_be_whole();
    }
    /// Kills the host at its n-th operation, during a print.
    void must_die(long deed) {
        life->dies_at = deed;
        REQUIRE_FALSE(start());
    }
    [[nodiscard]] int lights() const { return twin->log().exposures; }
    [[nodiscard]] std::filesystem::path journal() const { return folder.path() / "halves.zip.journal"; }
};

}  // namespace pliant::app
