#include "studio/files/thumbnails.hpp"

#include <fmt/format.h>

#include <chrono>
#include <tuple>
#include <utility>
#include <vector>

#include "base/core/boxes.hpp"
#include "presentation/draw/camera.hpp"
#include "presentation/draw/canvas.hpp"
#include "presentation/draw/raycast.hpp"
#include "presentation/draw/surface.hpp"
#include "presentation/scene/scene.hpp"
#include "robot/bodies/build.hpp"
#include "robot/file/robot_file.hpp"

namespace pliant::studio {
namespace {

constexpr std::size_t most_kept = 200;
constexpr std::chrono::seconds longest{15};

/// Cancels drawing that takes too long, or is not wanted any more.
class Hurry final : public Progress {
public:
    explicit Hurry(std::stop_token stop) : stop_(std::move(stop)) {}
    [[nodiscard]] bool cancelled() const override {
        return stop_.stop_requested() || std::chrono::steady_clock::now() > end_;
    }

private:
    std::stop_token stop_;
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

PictureStyle first_picture_style(bool dark) {
    using report::Colour;
    // As RobotView::lookAt('home') in web/src/simulate/view.ts and --stage-top, --stage-bottom in web/src/style.css.
    PictureStyle style{720, 480, Vec3{0.55, -1.25, 0.62}, {0.13, 0.13, 0.13, 0.13}, {}};
    style.backdrop = dark ? std::pair{Colour{0.137, 0.157, 0.180}, Colour{0.078, 0.090, 0.102}}
                          : std::pair{Colour{0.984, 0.980, 0.973}, Colour{0.890, 0.890, 0.875}};
    return style;
}

Result<std::string> draw_robot(const std::string& text, const std::filesystem::path& file, const PictureStyle& style,
                               std::stop_token stop) {
    const Result<robot::Robot> robot = robot::parse_robot(text, file);
    if (!robot) return tl::unexpected(robot.error());
    Hurry hurry(std::move(stop));
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
    const Box3 box = bounds_of(drawn->surface.points);
    scene.floor_z_m = box.low.z;
    scene.cable_radius_m = 0.006 * box.diagonal();
    if (style.backdrop) std::tie(scene.backdrop_top, scene.backdrop_bottom) = *style.backdrop;
    const report::Camera side =
        style.towards_eye ? report::view_from(*style.towards_eye) : report::choose_view(drawn->surface.points, {});
    const double aspect = static_cast<double>(style.width_px) / style.height_px;
    const report::Camera camera = report::fitted(side, seen, aspect, style.margins);
    const Result<report::Image> image = report::render(scene, camera, style.width_px, style.height_px, hurry);
    if (!image) return tl::unexpected(image.error());
    auto made = report::Canvas::create(style.width_px, style.height_px, scene.backdrop_top);
    if (!made) return tl::unexpected(made.error());
    report::Canvas& canvas = *made;
    canvas.image(*image, 0, 0);
    return canvas.png();
}

std::shared_ptr<const std::string> Thumbnails::of(const std::string& text, const std::filesystem::path& file,
                                                  const ProjectFolder& folder, const PictureStyle& style,
                                                  std::span<const std::string> outside, const std::stop_token& stop) {
    if (!folder.check_texts(text, file, outside)) return nullptr;
    const std::string key =
        fmt::format("{} {} {}\n", style.width_px, style.height_px, style.backdrop ? style.backdrop->first.r : 0) +
        text + folder.stamps_of(text, file);
    const std::lock_guard lock(mutex_);
    if (const auto known = known_.find(key); known != known_.end()) return known->second;
    std::shared_ptr<const std::string> picture;
    Result<std::string> png = draw_robot(text, file, style, stop);
    if (!png && stop.stop_requested()) return nullptr;
    if (png) picture = std::make_shared<const std::string>(std::move(*png));
    if (known_.size() >= most_kept) known_.clear();
    known_.emplace(key, picture);
    return picture;
}

}  // namespace pliant::studio
