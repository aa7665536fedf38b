// One print on a wire whose other end is a function: the order of what is sent, and what remains after a failure.
#include "printing/host/control.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "printing/host/test_devices.hpp"

using namespace pliant;
using namespace pliant::host;
using namespace pliant::host::test;

namespace {

const std::string job_text =
    "; a job\n;@stop M107 P1\nG28 Z\nG90\nG1 Z1 F60 ; down\nM400\n;@expose layer=0 material=1 seconds=2.5 "
    "image=a.png\nG1 Z5 F60\n";

Result<job::Image> image_of(int layer, int material) {
    return job::Image{1, 1, {static_cast<std::uint8_t>(10 * layer + material)}};
}

/// A machine of one axis, without switches.
machine::Printer one_axis() {
    machine::Printer printer = machine::load_printer("examples/printers/single.toml").value();
    printer.limit_switches.clear();
    printer.door = {};
    return printer;
}

struct Bench {
    CountingClock clock;
    RememberingProjector projector;
    std::function<std::string(const std::string&)> answer;
    std::function<Status()> at_read;  ///< as that of the wire
    int opened = 0;                   ///< number of times
    std::vector<Given> lights;
    std::vector<std::string> written;  ///< survives the wire
    Control control{setup()};

    explicit Bench(std::function<std::string(const std::string&)> says) : answer(std::move(says)) {}

    ControlSetup setup() {
        ControlSetup s{one_axis(),
                       [this]() -> Result<std::unique_ptr<Wire>> {
                           ++opened;
                           auto wire = std::make_unique<ScriptedWire>(clock, [this](const std::string& line) {
                               written.push_back(line);
                               return answer(line);
                           });
                           wire->at_read = [this] { return at_read ? at_read() : Status{}; };
                           return wire;
                       },
                       projector,
                       clock,
                       {},
                       {}};
        s.after_light = [this](const Given& given) { lights.push_back(given); };
        return s;
    }
    Status load(const std::string& text, const ImageSource& images = image_of) {
        PrintJob job;
        job.name = "a job";
        job.gcode = text;
        job.images = images;
        job.materials = {"soft", "firm"};
        job.layers = 1;
        return control.load(std::move(job));
    }
    /// The error of load(), or the outcome of the print.
    Status print(const std::string& text, const ImageSource& images = image_of) {
        if (Status loaded = load(text, images); !loaded) return loaded;
        REQUIRE(control.start({}));
        control.serve_until_idle();
        const Snapshot last = control.snapshot();
        return last.finished ? Status{} : failure("{}", last.message);
    }
    int index_of(const std::string& part) const {
        for (std::size_t i = 0; i < written.size(); ++i) {
            if (written[i].find(part) != std::string::npos) return static_cast<int>(i);
        }
        return -1;
    }
};

}  // namespace

TEST_CASE("commands go to the wire; an exposure begins behind a fence and lasts its time") {
    Bench b(good_answer);
    const Status status = b.print(job_text);
    REQUIRE_MESSAGE(status, (status ? "" : status.error().message));
    REQUIRE(b.projector.shown.size() == 1);
    CHECK(b.projector.shown[0].pixels[0] == 1);
    CHECK_FALSE(b.projector.lit);
    REQUIRE(b.lights.size() == 1);
    CHECK(b.lights[0].material == 1);
    CHECK(b.lights[0].complete);
    CHECK(b.lights[0].seconds == near(2.5, {.relative = 1e-9}));
    const int down = b.index_of("G1 Z1 "), up = b.index_of("G1 Z5 "), asked = b.index_of("M114");
    CHECK(down >= 0);
    CHECK(asked > down);  // where it stands, between the move and the light
    CHECK(up > asked);
    CHECK(b.index_of("expose") == -1);
    CHECK(b.index_of("M410") == -1);
    CHECK(b.control.snapshot().lines_sent > 8);
}

TEST_CASE("an invalid or forbidden job is refused before the wire is opened") {
    for (const char* text : {"G90\nhello\n", ";@expose layer=0\n", "G28 Z\nG1 X1 X2\n", "G28 Z\nG90\nG1 Z-1 F60\n",
                             "G90\n;@expose layer=0 material=0 seconds=2.5 image=a.png\n"}) {
        CAPTURE(text);
        Bench b(good_answer);
        const Status status = b.print(text);
        REQUIRE_FALSE(status);
        CHECK(status.error().cause == Cause::input);
        CHECK_FALSE(b.opened);
    }
}

TEST_CASE("on any failure the projector goes black, motion stops and the outputs are switched off") {
    Bench b([](const std::string& line) {
        return line.find("Z5") != std::string::npos ? std::string("Error:interlock: no\n") : good_answer(line);
    });
    CHECK_FALSE(b.print(job_text));
    CHECK_FALSE(b.projector.lit);
    CHECK(b.index_of("M410") > b.index_of("G1 Z5"));
    CHECK(b.written.back() == "M107 P1");
    CHECK(b.lights.size() == 1);
}

TEST_CASE("a missing image stops the print with the light off") {
    Bench b(good_answer);
    const Status status = b.print(job_text, [](int, int) -> Result<job::Image> { return input_error("gone"); });
    REQUIRE_FALSE(status);
    CHECK(status.error().message == "gone");
    CHECK(b.projector.shown.empty());
    CHECK(b.index_of("M410") > 0);
}

TEST_CASE("after a controller restart nothing more is sent") {
    Bench b([](const std::string& line) {
        return line.find("Z5") != std::string::npos ? std::string("start\n") : good_answer(line);
    });
    CHECK_FALSE(b.print(job_text));
    CHECK(b.index_of("M410") == -1);
    CHECK_FALSE(b.projector.lit);
}

TEST_CASE("a request from before an emergency stop is not carried out, and the next one waits for the stop") {
    Bench b(&good_answer);
    REQUIRE(b.load(job_text));
    REQUIRE(b.control.connect());
    b.control.serve_until_idle();
    REQUIRE(b.control.state() == State::idle);
    REQUIRE(b.control.start({}));
    b.control.emergency_stop();
    CHECK_FALSE(b.control.home({}));
    b.control.serve_until_idle();
    CHECK(b.control.state() == State::halted);
    CHECK(b.control.snapshot().message.starts_with("emergency stop: the board is halted"));
    CHECK(b.index_of("G28") == -1);
    CHECK(b.projector.shown.empty());
    CHECK(b.opened == 1);

    REQUIRE(b.control.connect());
    b.control.serve_until_idle();
    CHECK(b.control.state() == State::idle);
    CHECK(b.opened == 2);
}

TEST_CASE("before a connection, too, an emergency stop ends what was requested") {
    Bench b(&good_answer);
    REQUIRE(b.control.connect());
    b.control.emergency_stop();
    b.control.serve_until_idle();
    CHECK(b.control.state() == State::halted);
    CHECK(b.opened == 0);
}

TEST_CASE("a manual command that arrives while the link fails is dropped") {
    Bench b(&good_answer);
    REQUIRE(b.control.connect());
    b.control.serve_until_idle();
    REQUIRE(b.control.state() == State::idle);
    b.at_read = [&b] {
        CHECK(b.control.home({}));
        b.control.quit();
        return failure("the device is gone");
    };
    b.control.serve();
    CHECK(b.control.state() == State::halted);
    CHECK(b.index_of("G28") == -1);
}

TEST_CASE("a move by hand has a speed that G-code can express") {
    Bench b(&good_answer);
    CHECK(b.control.jog(machine::Axis::platform, 1000, 1e-6).error().message ==
          "a speed of 1e-06 mm/s: the slowest is 0.01 mm/s");
    CHECK_FALSE(b.control.jog(machine::Axis::platform, 1000, -1));
}
