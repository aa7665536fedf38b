#include "presentation/studio/thumbnails.hpp"

#include <fmt/format.h>

#include <chrono>
#include <vector>

#include "presentation/draw/camera.hpp"
#include "presentation/draw/canvas.hpp"
#include "presentation/draw/raycast.hpp"
#include "presentation/draw/surface.hpp"
#include "presentation/scene/scene.hpp"
#include "robot/bodies/build.hpp"
#include "robot/file/robot_file.hpp"

namespace pliant::studio {
namespace {

constexpr int width_px = 240, height_px = 150;
constexpr std::size_t most_kept = 200;
constexpr std::chrono::seconds longest{15};

/// Cancels drawing that takes too long.
class Hurry final : public Progress {
public:
    [[nodiscard]] bool cancelled() const override { return std::chrono::steady_clock::now() > end_; }

private:
    std::chrono::steady_clock::time_point end_ = std::chrono::steady_clock::now() + longest;
};

/// All bodies as one surface, with the material of each point.
struct Drawn {
    mesh::TriMesh surface;
    std::vector<int> material;
};

Result<Drawn> drawn_bodies(const robot::Robot& robot, Progress& progress) {
    const auto bodies = robot::body_surfaces(robot, progress);
    if (!bodies) return tl::unexpected(bodies.error());
    Drawn all;
    for (const robot::BodySurface& body : *bodies) {
        const auto first = static_cast<int>(all.surface.points.size());
        for (const Vec3& p : body.surface_m.points) all.surface.points.push_back(p);
        for (const auto& t : body.surface_m.triangles)
            all.surface.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
        all.material.resize(all.surface.points.size(), body.material);
    }
    if (all.surface.triangles.empty()) return input_error("{}: there is nothing to draw", robot.name);
    return all;
}

}  // namespace

Result<std::string> draw_thumbnail(const std::string& text, const std::filesystem::path& file) {
    const Result<robot::Robot> robot = robot::parse_robot(text, file);
    if (!robot) return tl::unexpected(robot.error());
    Hurry hurry;
    const Result<Drawn> drawn = drawn_bodies(*robot, hurry);
    if (!drawn) return tl::unexpected(drawn.error());
    const report::Surface surface = report::rigid_surface(drawn->surface);
    report::Scene scene;
    scene.surface = &surface;
    scene.body = report::pose(surface, drawn->surface.points);
    for (const int point : surface.vertex_node) {
        const int material = drawn->material[static_cast<std::size_t>(point)];
        scene.vertex_colours.push_back(view::colour_of(*robot, static_cast<std::size_t>(material)));
    }
    std::vector<Vec3> seen = drawn->surface.points;
    for (const robot::CableSpec& cable : robot->cables) {
        std::vector<Vec3> points;
        for (const Vec3& p : cable.points) points.push_back(robot->unit_m * p);
        seen.insert(seen.end(), points.begin(), points.end());
        scene.cables.push_back({std::move(points)});
    }
    Box3 box;
    for (const Vec3& p : drawn->surface.points) box.add(p);
    scene.floor_z_m = box.low.z;
    scene.cable_radius_m = 0.006 * box.diagonal();
    const report::Camera camera = report::fitted(report::choose_view(drawn->surface.points, {}), seen,
                                                 static_cast<double>(width_px) / height_px, {0.07, 0.07, 0.10, 0.07});
    const Result<report::Image> image = report::render(scene, camera, width_px, height_px, hurry);
    if (!image) return tl::unexpected(image.error());
    report::Canvas canvas(width_px, height_px, scene.backdrop_top);
    canvas.image(*image, 0, 0);
    return canvas.png();
}

std::shared_ptr<const std::string> Thumbnails::of(const std::string& text, const std::filesystem::path& file,
                                                  const ProjectFolder& folder) {
    const std::string key = text + folder.stamps_of(text, file);
    const std::lock_guard lock(mutex_);
    if (const auto known = known_.find(key); known != known_.end()) return known->second;
    std::shared_ptr<const std::string> picture;
    if (folder.texts_leading_outside(text, file).empty()) {
        Result<std::string> png = draw_thumbnail(text, file);
        if (png) picture = std::make_shared<const std::string>(std::move(*png));
    }
    if (known_.size() >= most_kept) known_.clear();
    known_.emplace(key, picture);
    return picture;
}

}  // namespace pliant::studio
