// A running print: sends a job's G-code and keeps the projector in step with it.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/progress.hpp"
#include "printing/wire/devices.hpp"
#include "printing/wire/link.hpp"

namespace pliant::host {

/// The image of a layer and a material (indices into the manifest).
using ImageSource = std::function<Result<job::Image>(int layer, int material)>;

struct Devices {
    Wire& wire;
    Projector& projector;
    Clock& clock;
};

struct Exposure {
    int layer = 0;
    int material = 0;
    double start_s = 0;  ///< on the clock, counted from the beginning of the print
    double on_s = 0;     ///< how long the light was on
};

/// What has happened, also if the print stopped.
struct PrintRecord {
    std::vector<Exposure> exposures;
    long lines_sent = 0;
    long resends = 0;
    double seconds = 0;
};

/// Prints `gcode`. All of it is read before anything moves. At `;@expose` the image is fetched, a fence waits until the
/// machine stands still, the light is on for the time, then black. Whatever happens, the projector is black afterwards.
///
/// If anything fails, or `progress` says cancelled, motion is stopped at once (M410) and the job's `;@stop` commands
/// switch pump and fans off; the motors stay on, so that the platform does not sink. After a restart of the controller
/// nothing is sent at all. The axes must be homed before the machine is used again.
/// Errors: input (the G-code), failed (the print), cancelled.
[[nodiscard]] Status print_job(std::string_view gcode, const ImageSource& images, Devices devices, Progress& progress,
                               PrintRecord& record, const LinkOptions& options = {});

}  // namespace pliant::host
