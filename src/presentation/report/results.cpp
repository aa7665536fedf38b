#include "presentation/report/results.hpp"

#include <system_error>

#include "base/core/files.hpp"
#include "base/core/stopwatch.hpp"
#include "presentation/report/frames.hpp"
#include "presentation/report/gltf.hpp"
#include "presentation/report/html.hpp"
#include "presentation/report/pictures.hpp"
#include "presentation/report/summary.hpp"
#include "presentation/report/tables.hpp"

namespace pliant::report {
namespace fs = std::filesystem;

namespace {

Status write_data(const fs::path& folder, const Simulation& s, const Surface& surface, Progress& progress) {
    if (Status status = write_file(folder / "steps.csv", steps_csv(s.result)); !status) return status;
    if (Status status = write_file(folder / "markers.csv", markers_csv(s.result)); !status) return status;
    if (Status status = write_file(folder / "iterations.csv", iterations_csv(s.result)); !status) return status;
    if (Status status = write_frames(folder, s, progress); !status) return status;
    return write_file(folder / "robot.glb", robot_glb(s, surface));
}

Status write_pictures(const fs::path& folder, const std::vector<Picture>& pictures) {
    if (pictures.empty()) return {};
    std::error_code code;
    fs::create_directories(folder / "pictures", code);
    if (code) return failure("{}: cannot be made: {}", (folder / "pictures").string(), code.message());
    for (const Picture& picture : pictures) {
        if (Status status = write_file(folder / "pictures" / picture.file, picture.png); !status) return status;
    }
    return {};
}

/// False: cancelled while drawing; no film was written.
Result<bool> write_film(const fs::path& folder, const Simulation& s, const Surface& surface, PictureChoice choice,
                        Progress& drawing) {
    choice.size = usual_film_size;
    const Result<std::string> gif = draw_film(s, surface, choice, drawing);
    if (!gif && gif.error().cause == Cause::cancelled) return false;
    if (!gif) return tl::unexpected(gif.error());
    const Status status = write_file(folder / "film.gif", *gif);
    return status ? Result<bool>(true) : tl::unexpected(status.error());
}

}  // namespace

Result<Written> write_results(const fs::path& folder, const Simulation& simulation, const PictureChoice& choice,
                              Progress& writing, Progress& drawing) {
    if (Status status = check(simulation); !status) return tl::unexpected(status.error());
    Simulation s = simulation;  // does not copy the mesh and the result
    Stopwatch watch;
    const Surface surface = outer_surface(s.mesh, s.region_material);
    if (Status status = write_data(folder, s, surface, writing); !status) return tl::unexpected(status.error());
    s.timing.files_s = watch.read_s();

    auto pictures = draw_pictures(s, surface, choice, drawing);
    bool stopped = !pictures && pictures.error().cause == Cause::cancelled;
    if (stopped) pictures = std::vector<Picture>();
    if (!pictures) return tl::unexpected(pictures.error());
    if (Status status = write_pictures(folder, *pictures); !status) return tl::unexpected(status.error());
    if (choice.film && !stopped) {
        const Result<bool> filmed = write_film(folder, s, surface, choice, drawing);
        if (!filmed) return tl::unexpected(filmed.error());
        stopped = !*filmed;
    }
    if (!pictures->empty()) s.timing.pictures_s = watch.read_s();

    // Last, because both contain the time of the rest.
    Status status = write_file(folder / "report.html", report_html(s, *pictures));
    if (status) status = write_file(folder / "summary.json", summary_json(s));
    if (status && writing.cancelled()) status = cancelled();
    if (!status) return tl::unexpected(status.error());
    return Written{s.timing, stopped};
}

}  // namespace pliant::report
