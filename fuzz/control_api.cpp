// HTTP requests to a running host: method, path and body on one line each, three lines per request. The controller
// behaves well.
#include "printing/host/control_api.hpp"

#include <string>
#include <utility>

#include "input.hpp"
#include "printing/host/test_devices.hpp"
#include "printing/operate/programs.hpp"
#include "tower.hpp"

namespace {

using namespace pliant;
using namespace pliant::host;

std::string_view take_line(std::string_view& text) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    return line;
}

/// A control with a job, running in the calling thread.
struct Bench {
    host::test::CountingClock clock;
    host::test::RememberingProjector projector;
    int reads = 0;  ///< from the controller
    Control control{setup()};

    Bench() {
        PrintJob job;
        job.name = "two lines";
        job.gcode = "G28 Z\nG1 Z300 F600\n";
        job.images = [](int, int) -> Result<job::Image> { return input_error("none"); };
        job.materials = {"soft"};
        job.layers = 7;
        (void)control.load(std::move(job));
        control.serve_until_idle();
    }
    ControlSetup setup() {
        return {tower(),
                [this]() -> Result<std::unique_ptr<Wire>> {
                    auto wire = std::make_unique<host::test::ScriptedWire>(clock, [](const std::string& line) {
                        if (line.find("M119") != std::string::npos)
                            return std::string("x_min: open\nz_max: open\ny_min: open\nok\n");
                        return host::test::good_answer(line);
                    });
                    wire->at_read = [this]() -> Status {
                        constexpr int enough = 2000;  // nobody resumes a print that a request has paused
                        if (++reads > enough) (void)control.cancel();
                        return {};
                    };
                    return wire;
                },
                projector,
                clock,
                operate::programs_of(tower()),
                {},
                {},
                {},
                nullptr};
    }
};

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::string_view text = as_text(data, size);
    Bench bench;
    long last_event = 0;
    for (int i = 0; i < 6 && !text.empty(); ++i) {
        const std::string_view method = take_line(text), path = take_line(text), body = take_line(text);
        const ApiAnswer answer = handle_api(bench.control, method, path, body);
        if (answer.status < 200 || answer.status >= 500) __builtin_trap();
        if (i % 2 == 1) bench.control.serve_until_idle();
        (void)current_message(bench.control, last_event);
    }
    return 0;
}
