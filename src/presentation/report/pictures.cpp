#include "presentation/report/pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/core/boxes.hpp"
#include "base/core/counted.hpp"
#include "presentation/draw/canvas.hpp"
#include "presentation/draw/gif.hpp"
#include "presentation/draw/raycast.hpp"
#include "presentation/draw/stage_layout.hpp"
#include "presentation/report/drawn_elements.hpp"
#include "presentation/report/gltf.hpp"
#include "presentation/report/overlay.hpp"

namespace pliant::report {
namespace {

constexpr double heading_share = 0.12;  // of the height, above the stages
constexpr std::array<double, 4> plain_margins = {0.06, 0.06, 0.12, 0.14};
constexpr std::array<double, 4> bar_margins = {0.06, 0.16, 0.10, 0.14};
constexpr Colour stage_backdrop = {0.955, 0.962, 0.970};
constexpr double near_share = 0.25;  // of the robot's size: obstacles this near are included in the picture
constexpr double closed_opacity = 0.9, plane_opacity = 0.8;
constexpr std::size_t fitted_steps = 12;  // number of steps that must be in view, in addition to rest

std::string step_title(const Simulation& s, const sim::Step& step) {
    return step.index == 0 ? "at rest" : fmt::format("step {} of {}", step.index, s.result.steps.back().index);
}

/// The first two cables and the first two chambers, and how many more there are: "flexor 70 %, 71.3 N".
std::string actuators_line(const sim::Step& step) {
    constexpr std::size_t named = 2;
    constexpr double no_force_N = 1e-9;  // at rest, gap elements have only rounding errors
    std::vector<std::string> parts;
    for (std::size_t i = 0; i < std::min(named, step.cables.size()); ++i) {
        const auto& c = step.cables[i];
        const double tension_N = std::fabs(c.tension_N) < no_force_N ? 0 : c.tension_N;
        parts.push_back(fmt::format("{} {:.3g} %, {:.3g} N", c.name, 100 * c.length_ratio, tension_N));
    }
    if (step.cables.size() > named) parts.push_back(counted(step.cables.size() - named, "more cable"));
    for (std::size_t i = 0; i < std::min(named, step.chambers.size()); ++i) {
        const auto& c = step.chambers[i];
        parts.push_back(fmt::format("{} {:.4g} %, {:.3g} kPa", c.name, 100 * c.volume_ratio, 1e-3 * c.pressure_Pa));
    }
    if (step.chambers.size() > named) parts.push_back(counted(step.chambers.size() - named, "more chamber"));
    return fmt::format("{}", fmt::join(parts, " · "));
}

/// Shared by all pictures.
class Painter {
public:
    Painter(const Simulation& s, const Surface& surface, const PictureChoice& choice, Progress& progress)
        : s_(s), surface_(surface), size_(choice.size), progress_(progress) {
        std::vector<std::size_t> steps = thinned_steps(s.result.steps.size(), fitted_steps);
        steps.insert(steps.begin(), 0);
        std::vector<std::vector<Vec3>> clouds;
        clouds.reserve(steps.size());
        for (const std::size_t step : steps) clouds.push_back(pose(surface, s.result.steps[step].positions).positions);
        const std::vector<std::span<const Vec3>> moved(clouds.begin() + 1, clouds.end());
        view_ = choice.towards_eye ? view_from(*choice.towards_eye) : choose_view(clouds.front(), moved);
        for (const auto& cloud : clouds) points_.insert(points_.end(), cloud.begin(), cloud.end());
        box_ = bounds_of(points_);
        floor_z_m_ = box_.low.z;
        for (const std::size_t step : steps) add_cable_points(step);
        for (const MeasuredPath& path : s.measured)
            points_.insert(points_.end(), path.points.begin(), path.points.end());
        for (const Obstacle& obstacle : s.obstacles) add_obstacle(obstacle, steps);
    }

    Result<Picture> rest();
    Result<Picture> final();
    Result<Picture> stages();
    Result<Picture> von_mises();
    Result<Picture> measured();
    Result<Image> film_frame(std::size_t step);

private:
    void add_cable_points(std::size_t step) {
        if (s_.cable_points.empty()) return;
        for (const auto& cable : s_.cable_points[step]) points_.insert(points_.end(), cable.begin(), cable.end());
    }
    void add_obstacle(const Obstacle& obstacle, std::span<const std::size_t> steps);
    [[nodiscard]] bool is_framed(const Obstacle& obstacle, const Box3& at_rest, std::size_t step) const;
    [[nodiscard]] Scene scene_of(std::size_t step) const;
    [[nodiscard]] std::vector<Colour> material_colours() const;
    [[nodiscard]] std::vector<std::pair<Colour, std::string>> legend() const;
    [[nodiscard]] Camera whole_camera(const std::array<double, 4>& margins) const {
        return fitted(view_, points_, static_cast<double>(size_.width_px) / size_.height_px, margins);
    }
    [[nodiscard]] Result<Canvas> drawn(const Scene& scene, const Camera& camera) const;
    [[nodiscard]] std::size_t last() const { return s_.result.steps.size() - 1; }

    const Simulation& s_;
    const Surface& surface_;
    PictureSize size_;
    Progress& progress_;
    Camera view_;
    std::vector<Vec3> points_;                  ///< everything that must be visible
    Box3 box_;                                  ///< of the robot over its whole motion
    double floor_z_m_ = 0;                      ///< of the robot's and the framed obstacles' motion
    std::vector<Surface> things_;               ///< (obstacles)
    std::vector<std::vector<double>> opacity_;  ///< (obstacles), per vertex
};

/// True for things near the robot and no larger than the robot's motion; large ones may extend beyond the picture.
bool Painter::is_framed(const Obstacle& obstacle, const Box3& at_rest, std::size_t step) const {
    if (obstacle.open || at_rest.diagonal() > box_.diagonal()) return false;
    Vec3 gap;
    for (std::size_t k = 0; k < 3; ++k) {
        const double low = at_rest.low[k] + obstacle.offset_m[step][k], high = low + at_rest.size()[k];
        gap[k] = std::max({0.0, box_.low[k] - high, low - box_.high[k]});
    }
    return norm(gap) < near_share * box_.diagonal();
}

/// Closed things are nearly opaque; a piece of a plane fades out towards its rim.
std::vector<double> opacity_of(const Obstacle& obstacle, const Surface& surface) {
    std::vector<double> opacity(surface.vertex_node.size(), closed_opacity);
    if (!obstacle.open) return opacity;
    const auto away = [&](int node) {
        return norm(obstacle.surface.points[static_cast<std::size_t>(node)] - obstacle.surface.points.front());
    };
    double farthest = 0;
    for (const int node : surface.vertex_node) farthest = std::max(farthest, away(node));
    for (std::size_t v = 0; v < opacity.size(); ++v)
        opacity[v] = away(surface.vertex_node[v]) > 0.9 * farthest ? 0 : plane_opacity;
    return opacity;
}

void Painter::add_obstacle(const Obstacle& obstacle, std::span<const std::size_t> steps) {
    things_.push_back(rigid_surface(obstacle.surface));
    opacity_.push_back(opacity_of(obstacle, things_.back()));
    const Box3 at_rest = mesh::bounds(obstacle.surface);
    for (const std::size_t step : steps) {
        if (!is_framed(obstacle, at_rest, step)) continue;
        for (const Vec3& p : obstacle.points_at(step)) {
            floor_z_m_ = std::min(floor_z_m_, p.z);
            points_.push_back(p);
        }
    }
}

Result<Picture> finished(const Canvas& canvas, std::string file, std::string title) {
    auto png = canvas.png();
    if (!png) return tl::unexpected(png.error());
    return Picture{std::move(file), std::move(title), std::move(*png)};
}

std::vector<Colour> Painter::material_colours() const {
    std::vector<Colour> colours(surface_.vertex_node.size());
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
        for (const int v : surface_.triangles[t]) {
            colours[static_cast<std::size_t>(v)] = colour_of(s_, surface_.material[t]);
        }
    }
    return colours;
}

/// "obstacle", "objects", or both.
std::string name_of_things(const std::vector<Obstacle>& things) {
    const auto objects = std::ranges::count_if(things, [](const Obstacle& o) { return !o.rotation.empty(); });
    const auto others = static_cast<std::ptrdiff_t>(things.size()) - objects;
    std::string name = others == 0 ? "" : others == 1 ? "obstacle" : "obstacles";
    if (objects > 0) name += std::string(name.empty() ? "" : ", ") + (objects == 1 ? "object" : "objects");
    return name;
}

std::vector<std::pair<Colour, std::string>> Painter::legend() const {
    std::vector<std::pair<Colour, std::string>> entries;
    for (int m = 0; m < static_cast<int>(s_.materials.size()); ++m) {
        if (std::find(surface_.material.begin(), surface_.material.end(), m) == surface_.material.end()) continue;
        entries.emplace_back(colour_of(s_, m), s_.materials[static_cast<std::size_t>(m)].name);
    }
    if (!s_.cable_points.empty() && !s_.cable_points.front().empty()) entries.emplace_back(cable_colour, "cable");
    const auto& actuates = s_.region_actuates;
    const auto first = std::find(actuates.begin(), actuates.end(), true);
    if (std::count(actuates.begin(), actuates.end(), true) > 1)
        entries.emplace_back(element_colour, "elements");
    else if (first != actuates.end())
        entries.emplace_back(element_colour,
                             "elements of " + s_.mesh.region_names[static_cast<std::size_t>(first - actuates.begin())]);
    if (!s_.measured.empty()) entries.emplace_back(measured_colour, s_.measured_as);
    if (!s_.obstacles.empty()) entries.emplace_back(obstacle_colour, name_of_things(s_.obstacles));
    return entries;
}

Scene Painter::scene_of(std::size_t step) const {
    Scene scene;
    scene.surface = &surface_;
    scene.body = pose(surface_, s_.result.steps[step].positions);
    scene.vertex_colours = material_colours();
    scene.cable_radius_m = drawn_cable_radius(s_);
    scene.floor_z_m = floor_z_m_;
    if (!s_.cable_points.empty()) {
        for (const auto& points : s_.cable_points[step]) scene.cables.push_back({points});
    }
    for (std::size_t k = 0; k < things_.size(); ++k) {
        scene.things.push_back(
            {&things_[k], pose(things_[k], s_.obstacles[k].points_at(step)), opacity_[k], s_.obstacles[k].open});
    }
    return scene;
}

Result<Canvas> Painter::drawn(const Scene& scene, const Camera& camera) const {
    const auto image = render(scene, camera, size_.width_px, size_.height_px, progress_);
    if (!image) return tl::unexpected(image.error());
    auto canvas = Canvas::create(size_.width_px, size_.height_px, scene.backdrop_top);
    if (canvas) canvas->image(*image, 0, 0);
    return canvas;
}

Frame whole(const Canvas& canvas) {
    return {{0, 0}, canvas.width(), canvas.height()};
}

Result<Picture> Painter::rest() {
    const Camera camera = whole_camera(plain_margins);
    auto canvas = drawn(scene_of(0), camera);
    if (!canvas) return tl::unexpected(canvas.error());
    draw_elements(*canvas, whole(*canvas), camera, s_, 0);
    draw_heading(*canvas, s_.robot, step_line(s_, 0));
    draw_legend(*canvas, legend());
    draw_scale_bar(*canvas, camera, box_.center());
    return finished(*canvas, "rest.png", "At rest");
}

Result<Picture> Painter::final() {
    const Camera camera = whole_camera(plain_margins);
    Scene scene = scene_of(last());
    if (last() > 0) scene.ghost = pose(surface_, s_.result.steps.front().positions);
    auto canvas = drawn(scene, camera);
    if (!canvas) return tl::unexpected(canvas.error());
    draw_elements(*canvas, whole(*canvas), camera, s_, last());
    draw_heading(*canvas, s_.robot, step_line(s_, last()));
    draw_measured(*canvas, camera, s_.measured);
    draw_marker_paths(*canvas, camera, s_.result);
    draw_legend(*canvas, legend());
    draw_scale_bar(*canvas, camera, box_.center());
    return finished(*canvas, "final.png", "At the end, over the rest shape");
}

/// With a uniform backdrop, which keeps films small.
Result<Image> Painter::film_frame(std::size_t step) {
    const Camera camera = whole_camera(plain_margins);
    Scene scene = scene_of(step);
    scene.backdrop_top = scene.backdrop_bottom = stage_backdrop;
    auto canvas = drawn(scene, camera);
    if (!canvas) return tl::unexpected(canvas.error());
    draw_elements(*canvas, whole(*canvas), camera, s_, step);
    draw_heading(*canvas, s_.robot, step_line(s_, step));
    draw_legend(*canvas, legend());
    return canvas->pixels();
}

Result<Picture> Painter::stages() {
    const int heading_px = static_cast<int>(heading_share * size_.height_px);
    const StageLayout layout =
        lay_out_stages(view_, points_, s_.result.steps.size(), size_.width_px, size_.height_px - heading_px);
    const double unit_px = size_.height_px / 1000.0;
    auto made = Canvas::create(size_.width_px, size_.height_px, stage_backdrop);
    if (!made) return tl::unexpected(made.error());
    Canvas& canvas = *made;
    for (std::size_t i = 0; i < layout.steps.size(); ++i) {
        Scene scene = scene_of(layout.steps[i]);
        scene.backdrop_top = scene.backdrop_bottom = stage_backdrop;
        const auto image = render(scene, layout.camera, layout.panel_width_px, layout.panel_height_px, progress_);
        if (!image) return tl::unexpected(image.error());
        const int x = static_cast<int>(i) % layout.columns * layout.panel_width_px;
        const int y = heading_px + static_cast<int>(i) / layout.columns * layout.panel_height_px;
        canvas.image(*image, x, y);
        const Frame panel{
            {x / unit_px, y / unit_px}, layout.panel_width_px / unit_px, layout.panel_height_px / unit_px};
        draw_elements(canvas, panel, layout.camera, s_, layout.steps[i]);
        const sim::Step& step = s_.result.steps[layout.steps[i]];
        draw_panel_caption(canvas, panel.corner, panel.width, step_title(s_, step), actuators_line(step));
    }
    draw_heading(canvas, s_.robot, "");
    return finished(canvas, "stages.png", "On the way");
}

Result<Picture> Painter::measured() {
    auto png = plot_png(measured_plot(s_.measured, s_.result, s_.measured_as));
    if (!png) return tl::unexpected(png.error());
    return Picture{s_.measured_as + ".png", "Markers, simulated and " + s_.measured_as, std::move(*png)};
}

/// Unit and factor for short numbers.
std::pair<std::string, double> stress_unit(double highest_Pa) {
    if (highest_Pa >= 2e6) return {"MPa", 1e-6};
    if (highest_Pa >= 2e3) return {"kPa", 1e-3};
    return {"Pa", 1};
}

Result<Picture> Painter::von_mises() {
    const sim::Step& step = s_.result.steps[last()];
    const auto fields = s_.fields(step.positions);
    const auto values = at_vertices(s_.mesh, s_.region_material, surface_, fields.von_mises_Pa);
    std::vector<double> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    const double highest = sorted.empty() ? 0 : sorted.back();
    const double most =
        sorted.empty() ? 0 : sorted[static_cast<std::size_t>(0.99 * static_cast<double>(sorted.size() - 1))];
    const auto [unit, factor] = stress_unit(most);
    const double top = nice_ceiling(factor * most);

    Scene scene = scene_of(last());
    for (std::size_t v = 0; v < values.size(); ++v) scene.vertex_colours[v] = field_colour(factor * values[v] / top);
    scene.cables.clear();
    scene.shading = 0.4;
    const Camera camera = whole_camera(bar_margins);
    auto canvas = drawn(scene, camera);
    if (!canvas) return tl::unexpected(canvas.error());
    draw_heading(*canvas, s_.robot, step_line(s_, last()));
    draw_colour_bar(*canvas, "von Mises stress", top, unit, factor * highest);
    draw_scale_bar(*canvas, camera, box_.center());
    return finished(*canvas, "von_mises.png", "Von Mises stress at the end");
}

}  // namespace

double nice_ceiling(double value) {
    if (!(value > 0) || !std::isfinite(value)) return 1;
    const double power = std::pow(10, std::floor(std::log10(value)));
    for (const double digit : {1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0}) {
        if (digit * power >= value * (1 - 1e-12)) return digit * power;
    }
    return 10 * power;
}

std::string step_line(const Simulation& s, std::size_t step) {
    const std::string actuators = actuators_line(s.result.steps[step]);
    return step_title(s, s.result.steps[step]) + (actuators.empty() ? "" : " · " + actuators);
}

Result<std::vector<Picture>> draw_pictures(const Simulation& s, const Surface& surface, const PictureChoice& choice,
                                           Progress& progress) {
    using Draw = Result<Picture> (Painter::*)();
    static constexpr std::array<Draw, 4> all = {&Painter::rest, &Painter::final, &Painter::stages, &Painter::von_mises};
    static constexpr std::array<Draw, 1> few = {&Painter::final};
    std::vector<Picture> pictures;
    if (choice.set == PictureSet::none) return pictures;
    const std::span<const Draw> wanted =
        choice.set == PictureSet::all ? std::span<const Draw>(all) : std::span<const Draw>(few);
    Painter painter(s, surface, choice, progress);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        progress.advance("pictures", static_cast<double>(i) / static_cast<double>(wanted.size()));
        auto picture = (painter.*wanted[i])();
        if (!picture) return tl::unexpected(picture.error());
        pictures.push_back(std::move(*picture));
    }
    if (!s.measured.empty()) {
        auto plot = painter.measured();
        if (!plot) return tl::unexpected(plot.error());
        pictures.push_back(std::move(*plot));
    }
    return pictures;
}

Result<std::string> draw_film(const Simulation& s, const Surface& surface, const PictureChoice& choice,
                              Progress& progress) {
    constexpr std::size_t most_frames = 60;
    constexpr int length_ms = 3000, pause_ms = 1200, shortest_ms = 40;
    std::vector<std::size_t> steps = thinned_steps(s.result.steps.size(), most_frames);
    if (steps.empty() || steps.front() != 0) steps.insert(steps.begin(), 0);
    Painter painter(s, surface, choice, progress);
    std::vector<Image> frames;
    for (std::size_t k = 0; k < steps.size(); ++k) {
        progress.advance("film", static_cast<double>(k) / static_cast<double>(steps.size()));
        auto frame = painter.film_frame(steps[k]);
        if (!frame) return tl::unexpected(frame.error());
        frames.push_back(std::move(*frame));
    }
    const int frame_ms = std::max(shortest_ms, length_ms / static_cast<int>(frames.size()));
    return animated_gif(frames, frame_ms, pause_ms);
}

}  // namespace pliant::report
