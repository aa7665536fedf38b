// A controlled print under realistic conditions: a worker thread, other threads that observe and send requests, and a
// virtual printer on a pseudo-terminal in a thread of its own, running thousands of times faster than real time.
#include <doctest/doctest.h>

#include <atomic>
#include <functional>
#include <thread>

#include "../shared_light.hpp"
#include "control_bench.hpp"
#include "printing/host/control_api.hpp"
#include "printing/twin/serve.hpp"
#include "printing/wire/scaled_time.hpp"
#include "printing/wire/serial.hpp"

using namespace pliant;
using namespace pliant::app;

namespace {

constexpr double speed = 200;

/// The machine's own clock, which slows down on a busy computer, so that nothing times out there.
class MachineClock final : public host::Clock {
public:
    [[nodiscard]] double now() const override { return now_s; }
    void sleep(double seconds) override {
        for (const double end_s = now_s + seconds; now_s < end_s;) ::usleep(500);
    }
    std::atomic<double> now_s = 0;
};

struct Live {
    ControlBench small;  // for its job and its printer
    SharedLight light;
    MachineClock clock;
    twin::Pty pty = twin::Pty::open().value();
    twin::Twin twin{small.printer};
    std::atomic<bool> stop = false;
    host::Control control{setup()};
    std::thread machine{[this] {
        twin::ServeOptions options;
        options.speed = speed;
        options.stop = [this] { return stop.load(); };
        options.lights = [this](twin::Twin& t) { return light.look(t); };
        options.tick = [this](double now_s) { clock.now_s = now_s; };
        options.longest_step_s = 0.1 / speed;
        CHECK(twin::serve(twin, pty, options));
    }};
    std::thread worker{[this] { control.serve(); }};

    host::ControlSetup setup() {
        return {small.printer,
                [this]() -> Result<std::unique_ptr<host::Wire>> {
                    auto port = host::SerialWire::open(pty.device(), 115200);
                    if (!port) return tl::unexpected(port.error());
                    return std::make_unique<host::ScaledWire>(std::make_unique<host::SerialWire>(std::move(*port)),
                                                              speed);
                },
                light,
                clock,
                operate::programs_of(small.printer),
                operate::link_options(small.printer.controller),
                {},
                {},
                nullptr};
    }
    host::PrintJob job() const {
        host::PrintJob job;
        job.name = "halves";
        job.digest = "x";
        job.gcode = small.gcode;
        job.images = halves::image;
        job.materials = {"soft", "rigid"};
        job.layers = 5;
        job.journal = small.folder.path() / "live.journal";
        job.sync_journal = false;
        return job;
    }
    ~Live() { end(); }
    void end() {
        control.quit();
        if (worker.joinable()) worker.join();
        stop = true;
        if (machine.joinable()) machine.join();
    }
    bool reaches(const std::function<bool()>& what) const {
        for (int i = 0; i < 60000; ++i) {
            if (what()) return true;
            ::usleep(1000);
        }
        tell();
        return false;
    }
    /// Prints what the engine was doing instead, and its messages.
    void tell() const {
        MESSAGE("state: ", std::string(host::state_text(control.state())));
        for (const host::Event& event : control.events_since(0)) MESSAGE(event.kind, ": ", event.text);
    }
    bool reaches(host::State state) const {
        return reaches([&] { return control.snapshot().state == state; });
    }
};

}  // namespace

TEST_CASE("an emergency stop from another thread turns the projector off and reaches the machine") {
    Live live;
    REQUIRE(live.control.connect());
    REQUIRE(live.reaches(host::State::idle));
    REQUIRE(live.control.load(live.job()));
    REQUIRE(live.control.start({}));
    REQUIRE(live.reaches([&] { return live.light.lit(); }));
    live.control.emergency_stop();
    CHECK(live.reaches(host::State::halted));
    CHECK_FALSE(live.light.lit());
    live.end();
    live.twin.receive("M105\n");
    CHECK(live.twin.take_output().find("ok") == std::string::npos);  // no answer until it is reset
}

TEST_CASE("an idle machine reports its limit switches, and they change as the axes move") {
    Live live;
    REQUIRE(live.control.connect());
    const auto pressed = [&](const char* name) -> std::optional<bool> {
        for (const machine::SwitchReading& reading : live.control.snapshot().switches) {
            if (reading.name == name) return reading.pressed;
        }
        return std::nullopt;
    };
    REQUIRE(live.reaches([&] { return pressed("x_min") && pressed("z_max") && pressed("y_min"); }));
    CHECK_FALSE(live.control.snapshot().door_open);  // this one has none
    REQUIRE(live.reaches(host::State::idle));
    REQUIRE(live.control.home({}));
    REQUIRE(live.reaches(host::State::idle));
    CHECK(live.reaches([&] { return pressed("z_max") == true && pressed("y_min") == true; }));
    REQUIRE(live.control.jog(machine::Axis::platform, -20000, 0));
    CHECK(live.reaches([&] { return pressed("z_max") == false; }));
    REQUIRE(live.reaches(host::State::idle));
    REQUIRE(live.control.disconnect());
    CHECK(live.reaches([&] { return live.control.snapshot().switches.empty(); }));
}

TEST_CASE("a second host on the same port is refused while the first has it") {
    Live live;
    REQUIRE(live.control.connect());
    REQUIRE(live.reaches(host::State::idle));
    CHECK_FALSE(host::SerialWire::open(live.pty.device(), 115200));
    REQUIRE(live.control.disconnect());
    CHECK(live.reaches([&] { return host::SerialWire::open(live.pty.device(), 115200).has_value(); }));
}

TEST_CASE("other threads may read the state of a print and pause it; after quitting, the next host finds it parked") {
    Live live;
    REQUIRE(live.control.load(live.job()));
    REQUIRE(live.control.start({}));
    std::atomic<bool> looking = true;
    std::thread looker([&] {
        long seen = 0;
        while (looking) {
            (void)host::current_message(live.control, seen);
            (void)host::handle_api(live.control, "GET", "/api/printer", "");
            ::usleep(500);
        }
    });
    CHECK(live.reaches([&] { return live.control.snapshot().layer >= 0; }));
    CHECK(live.control.pause(host::PauseWhen::now));
    CHECK(live.reaches(host::State::paused));
    CHECK_FALSE(live.light.lit());
    CHECK(live.control.set_exposure(0, 3));
    CHECK(live.control.resume());
    CHECK(live.reaches(host::State::printing));
    live.control.quit();
    live.worker.join();
    looking = false;
    looker.join();
    CHECK(live.control.snapshot().can_resume);
    live.end();
    CHECK_FALSE(live.light.lit());
    CHECK_FALSE(live.twin.interlock().hooked_vat());
    CHECK(live.twin.log().violations.empty());
}
