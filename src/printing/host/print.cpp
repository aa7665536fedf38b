#include "printing/host/print.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <variant>

#include "printing/host/script.hpp"
#include "printing/machine/gcode.hpp"

namespace pliant::host {
namespace {

constexpr double cancel_check_s = 0.1;

/// One print from the first line to the last; the destructor leaves the projector black.
class Run {
public:
    Run(const ImageSource& images, Devices devices, Progress& progress, PrintRecord& record, const LinkOptions& options)
        : images_(images),
          devices_(devices),
          progress_(progress),
          record_(record),
          link_(devices.wire, devices.clock, options),
          begin_s_(devices.clock.now()) {}

    ~Run() { (void)devices_.projector.black(); }
    Run(const Run&) = delete;
    Run& operator=(const Run&) = delete;

    Status print(const Script& script) {
        Status status = link_.connect();
        if (status) status = steps(script);
        if (!status) {
            (void)devices_.projector.black();
            if (!link_.was_reset()) link_.stop(script.stop_commands);
        }
        record_.lines_sent = link_.lines_sent();
        record_.resends = link_.resends();
        record_.seconds = devices_.clock.now() - begin_s_;
        return status;
    }

private:
    Status steps(const Script& script) {
        if (Status status = devices_.projector.black(); !status) return status;
        const auto total = static_cast<double>(std::max<std::size_t>(1, script.steps.size()));
        for (std::size_t i = 0; i < script.steps.size(); ++i) {
            if (progress_.cancelled()) return cancelled();
            progress_.advance("print", static_cast<double>(i) / total);
            const auto* command = std::get_if<std::string>(&script.steps[i]);
            Status status =
                command != nullptr ? link_.send(*command) : expose(std::get<machine::Expose>(script.steps[i]));
            if (!status) return status;
        }
        if (Status status = link_.fence(); !status) return status;
        progress_.advance("print", 1);
        return {};
    }

    Status expose(const machine::Expose& wanted) {
        const auto image = images_(wanted.layer, wanted.material);
        if (!image) return tl::unexpected(image.error());
        if (Status status = link_.fence(); !status) return status;
        if (progress_.cancelled()) return cancelled();
        const double start = devices_.clock.now();
        if (Status status = devices_.projector.show(*image); !status) return status;
        const bool finished = wait_until(start + wanted.seconds);
        const Status dark = devices_.projector.black();
        record_.exposures.push_back({wanted.layer, wanted.material, start - begin_s_, devices_.clock.now() - start});
        if (!dark) return dark;
        return finished ? Status{} : Status(cancelled());
    }

    /// False if the caller cancelled before.
    bool wait_until(double end_s) {
        for (double left = end_s - devices_.clock.now(); left > 0; left = end_s - devices_.clock.now()) {
            if (progress_.cancelled()) return false;
            devices_.clock.sleep(std::min(left, cancel_check_s));
        }
        return true;
    }

    const ImageSource& images_;
    Devices devices_;
    Progress& progress_;
    PrintRecord& record_;
    Link link_;
    double begin_s_;
};

}  // namespace

Status print_job(std::string_view gcode, const ImageSource& images, Devices devices, Progress& progress,
                 PrintRecord& record, const LinkOptions& options) {
    const auto script = read_script(gcode);
    if (!script) return tl::unexpected(script.error());
    return Run(images, devices, progress, record, options).print(*script);
}

}  // namespace pliant::host
