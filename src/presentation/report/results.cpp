#include "presentation/report/results.hpp"

#include <optional>
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

struct Drawn {
    std::vector<Picture> pictures;
    std::string film;            ///< GIF; empty if it was not asked for
    std::optional<Error> error;  ///< why the rest is missing
};

/// A long run must not be lost because it cannot be drawn: what fails or is cancelled is left out.
Drawn draw(const Simulation& s, const Surface& surface, PictureChoice choice, Progress& progress) {
    auto pictures = draw_pictures(s, surface, choice, progress);
    if (!pictures) return {{}, {}, pictures.error()};
    Drawn drawn{std::move(*pictures), {}, {}};
    if (!choice.film) return drawn;
    choice.size = usual_film_size;
    Result<std::string> film = draw_film(s, surface, choice, progress);
    if (film)
        drawn.film = std::move(*film);
    else
        drawn.error = film.error();
    return drawn;
}

Status write_pictures(const fs::path& folder, const Drawn& drawn) {
    if (!drawn.film.empty()) {
        if (Status status = write_file(folder / "film.gif", drawn.film); !status) return status;
    }
    if (drawn.pictures.empty()) return {};
    std::error_code code;
    fs::create_directories(folder / "pictures", code);
    if (code) return failure("{}: cannot be made: {}", (folder / "pictures").string(), code.message());
    for (const Picture& picture : drawn.pictures) {
        if (Status status = write_file(folder / "pictures" / picture.file, picture.png); !status) return status;
    }
    return {};
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

    const Drawn drawn = draw(s, surface, choice, drawing);
    if (Status status = write_pictures(folder, drawn); !status) return tl::unexpected(status.error());
    if (!drawn.pictures.empty()) s.timing.pictures_s = watch.read_s();

    // Last, because both contain the time of the rest.
    Status status = write_file(folder / "report.html", report_html(s, drawn.pictures));
    if (status) status = write_file(folder / "summary.json", summary_json(s));
    if (status && writing.cancelled()) status = cancelled();
    if (!status) return tl::unexpected(status.error());
    const bool stopped = drawn.error && drawn.error->cause == Cause::cancelled;
    return Written{s.timing, stopped, drawn.error && !stopped ? drawn.error->message : std::string()};
}

}  // namespace pliant::report
