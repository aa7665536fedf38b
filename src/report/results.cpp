#include "report/results.hpp"

#include <system_error>

#include "core/files.hpp"
#include "report/frames.hpp"
#include "report/gltf.hpp"
#include "report/html.hpp"
#include "report/pictures.hpp"
#include "report/summary.hpp"
#include "report/tables.hpp"

namespace pliant::report {

Status write_results(const std::filesystem::path& folder, const Simulation& s, Progress& progress,
                     const PictureSize& picture_size) {
    if (Status status = check(s); !status) return status;
    if (Status status = write_file(folder / "summary.json", summary_json(s)); !status) return status;
    if (Status status = write_file(folder / "steps.csv", steps_csv(s.result)); !status) return status;
    if (Status status = write_file(folder / "markers.csv", markers_csv(s.result)); !status) return status;
    if (Status status = write_file(folder / "iterations.csv", iterations_csv(s.result)); !status) return status;
    if (Status status = write_frames(folder, s, progress); !status) return status;

    const Surface surface = outer_surface(s.mesh, s.region_material);
    if (Status status = write_file(folder / "robot.glb", robot_glb(s, surface)); !status) return status;
    const auto pictures = draw_pictures(s, surface, picture_size, progress);
    if (!pictures) return tl::unexpected(pictures.error());
    std::error_code code;
    std::filesystem::create_directories(folder / "pictures", code);
    if (code) return failure("{}: cannot be made: {}", (folder / "pictures").string(), code.message());
    for (const Picture& picture : *pictures) {
        if (Status status = write_file(folder / "pictures" / picture.file, picture.png); !status) return status;
    }
    return write_file(folder / "report.html", report_html(s, *pictures));
}

}  // namespace pliant::report
