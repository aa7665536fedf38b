// The bench of tests of a controlled print: a small job of two materials, a twin, a control that is served in the
// calling thread, and ways to end a host in the middle.
#pragma once

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "host/control.hpp"
#include "host/journal.hpp"
#include "operate/programs.hpp"
#include "plan/plan.hpp"
#include "twin/inspect.hpp"
#include "twin_bench.hpp"

namespace pliant::app {

/// Thrown by the devices of a host that has been killed: nothing that it does afterwards reaches anything.
struct Killed {};

/// Counts what a host does at its devices; at the n-th time it dies.
struct Life {
    long deeds = 0;
    long dies_at = -1;
    bool dead = false;
    bool unplugged = false;  ///< the cable of the machine
    int resets = 0;          ///< of the controller, asked for by the host
    std::function<void()> on_death;
    /// Called at every deed on the wire: for mishaps in the middle.
    std::function<void(long)> at_deed;
    /// Called whenever the host listens: for wishes.
    std::function<void()> at_look;

    bool act(bool on_wire = true) {
        if (dead) return false;
        ++deeds;
        if (at_deed && on_wire) at_deed(deeds);
        if (deeds != dies_at) return true;
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
    TwinWire wire_;
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

/// A guard that sees everything, as the process of its own does.
class SeeingGuard final : public host::Guard {
public:
    void lit(long light) override { light_ = light; }
    void dark() override { light_ = 0; }
    [[nodiscard]] std::optional<double> dark_at(long light) override {
        return light == seen_ ? std::optional(at_s_) : std::nullopt;
    }
    void host_died(double now_s) {
        if (light_ != 0) seen_ = light_, at_s_ = now_s;
        light_ = 0;
    }

private:
    long light_ = 0;
    long seen_ = -1;
    double at_s_ = 0;
};

struct ControlBench {
    static constexpr int width = 8, height = 6;
    int layers = 5;
    machine::Printer printer;
    job::Manifest job;
    std::string gcode;
    std::filesystem::path folder;
    std::unique_ptr<twin::Twin> twin;
    std::unique_ptr<Life> life = std::make_unique<Life>();
    SeeingGuard guard;
    bool guarded = true;
    bool sync = false;
    host::LayerHook after_layer;
    std::vector<host::Refill> refills;
    std::unique_ptr<TwinClock> clock;
    std::unique_ptr<MortalProjector> projector;
    std::unique_ptr<host::Control> control;
    std::string first_error;

    explicit ControlBench(twin::Options options = {}, const std::string& name = "tower", int layer_count = 5)
        : layers(layer_count) {
        printer = machine::load_printer(fmt::format("examples/printers/{}.toml", name)).value();
        printer.projector.width_px = width;
        printer.projector.height_px = height;
        printer.projector.pixel_um = 158.75;
        std::string pattern = (std::filesystem::temp_directory_path() / "pliant_control_XXXXXX").string();
        folder = ::mkdtemp(pattern.data());
        make_job();
        twin = std::make_unique<twin::Twin>(printer, std::move(options));
        new_host();
    }
    ~ControlBench() {
        control.reset();
        std::filesystem::remove_all(folder);
    }
    ControlBench(const ControlBench&) = delete;
    ControlBench& operator=(const ControlBench&) = delete;

    /// Left half soft, right half rigid, with a grey column between them that both share.
    static Result<job::Image> image(int, int material) {
        job::Image image{width, height, std::vector<std::uint8_t>(width * height)};
        for (int i = 0; i < width * height; ++i) {
            const int x = i % width;
            const int soft = x < 4 ? 255 : (x == 4 ? 100 : 0);
            image.pixels[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(material == 0 ? soft : 255 - soft);
        }
        return image;
    }

    void make_job() {
        job.name = "halves";
        job.width_px = width;
        job.height_px = height;
        job.pixel_um = 158.75;
        job.bottom_layers = 2;
        const double pixel_mm2 = 0.15875 * 0.15875;
        const double soft_mm2 = pixel_mm2 * (24 + 6 * 100.0 / 255);
        const double rigid_mm2 = pixel_mm2 * 48 - soft_mm2;
        const std::string first = printer.vats.front().resin, last = printer.vats.back().resin;
        job.materials = {{"soft", first, soft_mm2 * 0.05 * layers, 0, 2.5, 12},
                         {"rigid", last, rigid_mm2 * 0.05 * layers, 0, 2.5, 12}};
        for (int i = 0; i < layers; ++i)
            job.layers.push_back({50 * (i + 1), 50, {{0, "soft.png", soft_mm2}, {1, "rigid.png", rigid_mm2}}});
        auto planned = plan::make_plan(job, printer);
        REQUIRE_MESSAGE(planned, (planned ? "" : planned.error().message));
        const plan::Plan& plan = *planned;
        gcode = plan::write_gcode(plan, job, printer);
    }

    /// A host that knows nothing but the journal. What the one before had open is closed, as the system does.
    void new_host() {
        control.reset();
        life = std::make_unique<Life>();
        clock = std::make_unique<TwinClock>(*twin);
        projector = std::make_unique<MortalProjector>(*twin, *life);
        host::ControlSetup setup{
            printer,
            [this]() -> Result<std::unique_ptr<host::Wire>> { return std::make_unique<MortalWire>(*twin, *life); },
            *projector,
            *clock,
            operate::programs_of(printer),
            operate::link_options(printer.controller),
            {},
            [this](int layer) {
                if (after_layer) after_layer(layer);
            },
            guarded ? &guard : nullptr};
        life->on_death = [this] {
            guard.host_died(twin->now());
            twin->light_off();
        };
        control = std::make_unique<host::Control>(std::move(setup));
        host::PrintJob ready;
        ready.name = job.name;
        ready.digest = host::job_digest(gcode);
        ready.gcode = gcode;
        ready.images = image;
        ready.materials = {"soft", "rigid"};
        ready.layers = layers;
        ready.refills = refills;
        ready.journal = folder / "halves.zip.journal";
        ready.sync_journal = sync;
        const Status loaded = control->load(std::move(ready));
        REQUIRE_MESSAGE(loaded, (loaded ? "" : loaded.error().message));
        control->serve_until_idle();
    }

    /// True if the host lived to the end of what it was asked for.
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
    [[nodiscard]] twin::Report report() { return twin::inspect(*twin, job, twin::ImageSource(image)).value(); }
    void must_be_whole() {
        const twin::Report r = report();
        CHECK_MESSAGE(r.passed, twin::report_text(r));
    }
    [[nodiscard]] int lights() const { return twin->log().exposures; }
    [[nodiscard]] std::filesystem::path journal() const { return folder / "halves.zip.journal"; }
};

}  // namespace pliant::app
