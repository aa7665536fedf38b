#include "results.hpp"

#include <fmt/core.h>

#include <cstddef>
#include <system_error>
#include <vector>

#include "base/core/counted.hpp"
#include "base/core/files.hpp"
#include "presentation/report/results.hpp"
#include "presentation/report/summary.hpp"
#include "presentation/report/tables.hpp"
#include "simulation/distributed/frames.hpp"

namespace pliant::app {
namespace {

namespace fs = std::filesystem;

/// Of the steps that have a frame in this folder.
std::vector<sim::distributed::FrameTime> frame_times(const fs::path& frames, const sim::Trajectory& result) {
    std::vector<sim::distributed::FrameTime> times;
    std::error_code code;
    for (const sim::Step& step : result.steps)
        if (fs::exists(frames / fmt::format("{:04}.h5", step.index), code)) times.push_back({step.index, step.time});
    return times;
}

Status move_frames(const fs::path& kept, const fs::path& folder, const report::Simulation& s) {
    const fs::path frames = kept / "frames";
    const auto times = frame_times(frames, s.result);
    if (times.empty()) return {};
    std::error_code code;
    fs::rename(frames, folder / "frames", code);
    if (code) return failure("{}: cannot be moved: {}", frames.string(), code.message());
    fs::create_directory(frames, code);  // by which the folder is known until it is deleted
    return write_file(folder / "frames.xdmf",
                      sim::distributed::frames_xdmf(s.robot, static_cast<int>(s.mesh.points.size()),
                                                    static_cast<int>(s.mesh.tet_count()), s.mesh.order, times));
}

}  // namespace

Status write_results(const fs::path& folder, const fs::path& kept, const report::Simulation& s) {
    return write_folder(folder, report::simulation_mark(), [&](const fs::path& aside) {
        Status status = write_file(aside / "summary.json", report::summary_json(s));
        if (status) status = write_file(aside / "steps.csv", report::steps_csv(s.result));
        if (status) status = write_file(aside / "markers.csv", report::markers_csv(s.result));
        if (status) status = write_file(aside / "iterations.csv", report::iterations_csv(s.result));
        return status ? move_frames(kept, aside, s) : status;
    });
}

void print_summary(const report::Simulation& s, int ranks) {
    const sim::Step& last = s.result.steps.back();
    fmt::print("{}, {}, {}\n", counted(s.mesh.points.size(), "node"),
               counted(s.mesh.tet_count(), s.mesh.order == 2 ? "quadratic tet" : "linear tet"),
               counted(static_cast<std::size_t>(ranks), "rank"));
    fmt::print("{} in {:.2f} s, residual {:.1e}, smallest det F {:.3f}\n", counted(s.result.steps.size() - 1, "step"),
               s.result.solve_s, last.residual, last.min_J);
    for (const auto& c : last.cables)
        fmt::print("cable {}: length ratio {:.4f}, {:.2f} mm, tension {:.3f} N\n", c.name, c.length_ratio,
                   1e3 * c.length_m, c.tension_N);
    for (const auto& c : last.chambers)
        fmt::print("chamber {}: volume ratio {:.4f}, {:.1f} mm^3, pressure {:.3f} kPa\n", c.name, c.volume_ratio,
                   1e9 * c.volume_m3, 1e-3 * c.pressure_Pa);
    for (const auto& m : last.markers)
        fmt::print("marker {}: ({:.3f}, {:.3f}, {:.3f}) mm\n", m.name, 1e3 * m.position_m.x, 1e3 * m.position_m.y,
                   1e3 * m.position_m.z);
}

}  // namespace pliant::app
