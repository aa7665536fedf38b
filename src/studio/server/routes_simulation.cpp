// The interactive robot: its scene, and exports of its state.
#include "base/core/files.hpp"
#include "presentation/report/frames.hpp"
#include "presentation/report/gltf.hpp"
#include "presentation/report/tables.hpp"
#include "studio/base/access.hpp"
#include "studio/server/request_reading.hpp"
#include "studio/server/studio.hpp"

namespace pliant::studio {
namespace {

Response scene(Studio& studio, const Request&) {
    const auto packet = studio.simulation().scene();
    if (!packet) return nothing_built();
    return {200, "application/octet-stream", *packet};
}

Response frame(Studio& studio, const Request&) {
    // A newly built robot has no state yet: that is not an error.
    if (const auto packet = studio.simulation().last_frame()) return {200, "application/octet-stream", *packet};
    if (studio.simulation().scene()) return {200, "application/octet-stream", ""};
    return nothing_built();
}

Response table(Studio& studio, std::string (*write)(const sim::Trajectory&), const char* name) {
    const sim::Trajectory history = studio.simulation().history();
    if (history.steps.empty()) return nothing_built();
    return {200, "text/csv; charset=utf-8", write(history), name};
}

Response glb(Studio& studio, const Request&) {
    const auto built = studio.simulation().built();
    const sim::Trajectory history = studio.simulation().history();
    if (!built || history.steps.empty()) return nothing_built();
    const auto& regions = built->scene.region_material();
    const report::Simulation simulation = report::simulation_of(built->robot, built->model, history);
    return {200, "model/gltf-binary",
            report::robot_glb(simulation, report::outer_surface(built->model.mesh(), regions)), "robot.glb"};
}

/// The current state. The writer needs a folder, so a temporary one is used.
Response vtu(Studio& studio, const Request&) {
    const auto built = studio.simulation().built();
    sim::Trajectory history = studio.simulation().history();
    if (!built || history.steps.empty()) return nothing_built();
    history.steps.erase(history.steps.begin(), history.steps.end() - 1);
    const auto folder = std::filesystem::temp_directory_path() / ("pliant_studio_" + random_key());
    std::error_code error;
    std::filesystem::create_directories(folder / "frames", error);
    if (error) return error_response(failure("{}: {}", folder.string(), error.message()).value());
    const report::Simulation simulation = report::simulation_of(built->robot, built->model, history);
    Progress silent;
    const Status written = report::write_frames(folder, simulation, silent);
    Result<std::string> bytes = written ? read_file(folder / "frames" / "frame_0000.vtu")
                                        : Result<std::string>(tl::unexpected(written.error()));
    std::filesystem::remove_all(folder, error);
    if (!bytes) return error_response(bytes.error());
    return {200, "application/xml", std::move(*bytes), "robot.vtu"};
}

}  // namespace

void add_simulation_routes(std::vector<Route>& routes) {
    routes.push_back({"GET", "/api/scene", "what does not move: surfaces, materials, actuators",
                      "application/octet-stream", false, scene});
    routes.push_back({"GET", "/api/frame", "the latest state", "application/octet-stream", false, frame});
    routes.push_back({"GET", "/api/export/steps.csv", "tensions, pressures, reactions of the states since rest",
                      "text/csv", false,
                      [](Studio& s, const Request&) { return table(s, report::steps_csv, "steps.csv"); }});
    routes.push_back({"GET", "/api/export/markers.csv", "markers of the states since rest", "text/csv", false,
                      [](Studio& s, const Request&) { return table(s, report::markers_csv, "markers.csv"); }});
    routes.push_back(
        {"GET", "/api/export/robot.glb", "the motion since rest, animated", "model/gltf-binary", false, glb});
    routes.push_back(
        {"GET", "/api/export/robot.vtu", "the latest state with its fields", "application/xml", false, vtu});
}

}  // namespace pliant::studio
