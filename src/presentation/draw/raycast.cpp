#include "presentation/draw/raycast.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/core/boxes.hpp"
#include "base/core/parallel.hpp"
#include "presentation/draw/embree_scene.hpp"
#include "presentation/draw/lighting.hpp"

namespace pliant::report {
namespace {

constexpr int samples_across = 4;  // samples per pixel and direction, if its neighbours differ from it
constexpr int floor_cell_px = 4;   // the floor's soft shadow is computed at every fourth pixel
constexpr int light_cell_px = 4;   // likewise the light on smooth parts of the body
constexpr double light_contrast = 0.05;
constexpr double colour_contrast = 0.024;  // of neighbours, sRGB: six steps of 255
constexpr double bend_contrast = 0.97;     // cosine between their normals
constexpr std::size_t rows_at_once = 16;
constexpr double sky_strength = 0.64;
constexpr double key_strength = 0.60;
constexpr double bounced = 0.16;           // light that reaches the bottom of a slit by reflection
constexpr double floor_sky_shadow = 0.42;  // darkening of the backdrop where the sky is blocked
constexpr double floor_key_shadow = 0.26;
constexpr double floor_contrast = 0.04;
constexpr int floor_cells_skipped = 4;
constexpr double floor_fine_contrast = 0.01;
constexpr double ghost_clearance = 0.003;            // relative to the body's size: avoids flicker on faces that did
                                                     // not move
constexpr double cable_behind = 0.55;                // opacity of a cable inside the body
constexpr Colour ghost_colour = {0.42, 0.47, 0.54};  // sRGB

/// Index of a cell in an array of rows.
std::size_t cell(int columns, std::size_t row, std::size_t column) {
    return row * static_cast<std::size_t>(columns) + column;
}

/// Everything that is computed once per picture.
class Renderer {
public:
    /// Precondition: the device has no error.
    Renderer(const EmbreeDevice& device, const Scene& scene, const Camera& camera, int width, int height)
        : scene_(scene),
          camera_(camera),
          width_(width),
          height_(height),
          reach_(reach_of(scene)),
          lighting_(camera, reach_),
          body_(device),
          things_(device),
          shade_(device),
          cables_(device),
          ghost_(device) {
        body_.add_triangles(scene.body.positions, scene.surface->triangles);
        for (const Cable& cable : scene.cables) {
            if (cable.points.size() >= 2) cables_.add_tube(cable.points, scene.cable_radius_m);
        }
        if (scene.ghost) ghost_.add_triangles(scene.ghost->positions, scene.surface->triangles);
        shade_.add_triangles(scene.body.positions, scene.surface->triangles);
        add_things();
        body_.commit();
        things_.commit();
        shade_.commit();
        cables_.commit();
        ghost_.commit();
        for (const Colour& c : scene.vertex_colours) albedo_.push_back(to_linear(c));
        find_window();
        backdrop_top_ = to_linear(scene.backdrop_top);
        backdrop_bottom_ = to_linear(scene.backdrop_bottom);
        cable_albedo_ = to_linear(cable_colour);
        ghost_albedo_ = to_linear(ghost_colour);
        thing_albedo_ = to_linear(obstacle_colour);
    }

    /// Computed at every fourth cell, and in between where those differ.
    void prepare_floor(const Progress& progress) {
        constexpr int step = floor_cells_skipped;
        floor_columns_ = (width_ / floor_cell_px / step + 2) * step + 1;
        const int rows = (height_ / floor_cell_px / step + 2) * step + 1;
        floor_.assign(static_cast<std::size_t>(floor_columns_ * rows), 1.0);
        const auto coarse = static_cast<std::size_t>((rows - 1) / step);
        parallel_for(coarse + 1, 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end && !progress.cancelled(); ++k) {
                const int row = static_cast<int>(k) * step;
                for (int column = 0; column < floor_columns_; column += step) shade_floor_cell(row, column);
            }
        });
        // A square owns its upper and left edges, so that each cell is written once.
        parallel_for(coarse, 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end && !progress.cancelled(); ++k) {
                for (int column = 0; column + step < floor_columns_; column += step)
                    fill_floor_square(static_cast<int>(k) * step, column);
            }
        });
    }

    /// Hits of rays through every fourth pixel, and the light there.
    void prepare_light(const Progress& progress) {
        light_columns_ = width_ / light_cell_px + 2;
        const int rows = height_ / light_cell_px + 2;
        lights_.resize(static_cast<std::size_t>(light_columns_ * rows));
        parallel_for(static_cast<std::size_t>(rows), 2, [&](std::size_t begin, std::size_t end) {
            if (progress.cancelled()) return;
            for (std::size_t row = begin; row < end; ++row) {
                for (int column = 0; column < light_columns_; ++column) {
                    lights_[cell(light_columns_, row, static_cast<std::size_t>(column))] =
                        light_through(column * light_cell_px, static_cast<double>(row) * light_cell_px);
                }
            }
        });
    }

    /// sRGB of the rows `begin` .. `end`, row by row.
    [[nodiscard]] std::vector<Colour> rows(int begin, int end) const;

private:
    /// Position in the pixel where the body was hit, and the light there: shared by samples on the same smooth patch.
    struct Patch {
        Vec3 point, normal;
        Light light;
    };
    /// Data shared by the samples of one pixel.
    struct Shared {
        std::vector<Patch> patches, thing_patches;
        std::optional<double> floor;
    };
    /// What one ray sees.
    struct Sample {
        Colour colour;     ///< linear
        unsigned met = 0;  ///< one bit each for body, ghost, thing, cable
        Vec3 normal;       ///< of the body
    };

    static double reach_of(const Scene& scene) {
        const Box3 box = bounds_of(scene.body.positions);
        return std::max(1e-9, box.diagonal());
    }

    void add_things() {
        for (const Thing& thing : scene_.things) {
            const auto& triangles = thing.surface->triangles;
            if (triangles.empty() || (thing.open && !faces_the_eye(thing))) continue;
            things_.add_triangles(thing.place.positions, triangles);
            seen_.push_back(&thing);
            if (!thing.open) shade_.add_triangles(thing.place.positions, triangles);
        }
    }
    /// For a piece of a plane.
    [[nodiscard]] bool faces_the_eye(const Thing& plane) const {
        return dot(camera_.eye - plane.place.positions.front(), plane.place.normals.front()) > 0;
    }

    /// Finds the pixels outside which only backdrop and floor are visible.
    void find_window() {
        const double bead = 2 * scene_.cable_radius_m;
        const auto widen = [&](const Vec3& p, double radius) {
            const auto [u, v, depth] = camera_.project(p);
            if (!(depth > 0)) {  // a large thing that reaches behind the camera may be visible anywhere
                window_.add({0, 0, 0});
                window_.add({static_cast<double>(width_), static_cast<double>(height_), 0});
                return;
            }
            const double margin = 2 + radius / depth / camera_.half_height * height_;
            const double x = (u + 1) / 2 * width_, y = (1 - v) / 2 * height_;
            window_.add({x - margin, y - margin, 0});
            window_.add({x + margin, y + margin, 0});
        };
        for (const Vec3& p : scene_.body.positions) widen(p, 0);
        for (const Cable& cable : scene_.cables) {
            for (const Vec3& p : cable.points) widen(p, bead);
        }
        for (const Thing* thing : seen_) {
            for (const Vec3& p : thing->place.positions) widen(p, 0);
        }
        if (!scene_.ghost) return;
        for (const Vec3& p : scene_.ghost->positions) widen(p, 0);
    }

    [[nodiscard]] Colour backdrop_colour(double y, double floor) const {
        return floor * mix(backdrop_top_, backdrop_bottom_, y / height_);
    }

    [[nodiscard]] Vec3 ray(double x, double y) const {
        return camera_.direction(2 * x / width_ - 1, 1 - 2 * y / height_);
    }
    [[nodiscard]] double floor_shade(double x, double y) const;
    [[nodiscard]] double& floor_cell(int row, int column) {
        return floor_[cell(floor_columns_, static_cast<std::size_t>(row), static_cast<std::size_t>(column))];
    }
    void shade_floor_cell(int row, int column) {
        floor_cell(row, column) = floor_shade(column * floor_cell_px, row * floor_cell_px);
    }
    void fill_floor_square(int row, int column);
    [[nodiscard]] double floor_at(double x, double y) const;
    [[nodiscard]] std::optional<Patch> light_through(double x, double y) const;
    /// Interpolated between computed points, if they are on the smooth patch at `point` and their light differs little.
    [[nodiscard]] std::optional<Light> smooth_light(double x, double y, const Vec3& point, const Vec3& normal) const;
    [[nodiscard]] bool is_same_patch(const Patch& patch, const Vec3& point, const Vec3& normal) const {
        return dot(patch.normal, normal) > 0.98 && std::abs(dot(patch.normal, point - patch.point)) < 0.004 * reach_;
    }
    /// Blends the thing at `hit` over the colour `behind`.
    [[nodiscard]] Colour with_thing(const Colour& behind, const Hit& hit, const Vec3& direction, Shared& shared) const;
    [[nodiscard]] Colour with_ghost(const Colour& behind, const Hit& hit, const Vec3& direction) const;
    [[nodiscard]] Light patch_light(const Vec3& point, const Vec3& normal, const Vec3& geometric,
                                    std::vector<Patch>& patches) const;
    [[nodiscard]] Sample sample(double x, double y, Shared& shared) const;
    [[nodiscard]] Sample at_centre(int x, int y) const;
    /// Mean of many samples, sRGB.
    [[nodiscard]] Colour sampled_finely(int x, int y) const;
    [[nodiscard]] bool is_in_window(double x, double y) const { return window_.contains({x, y, 0}, 1); }
    [[nodiscard]] Colour lit(const Colour& albedo, const Vec3& normal, const Vec3& direction, const Light& light) const;

    const Scene& scene_;
    const Camera& camera_;
    int width_, height_;
    double reach_;
    Lighting lighting_;
    EmbreeScene body_, things_, shade_, cables_, ghost_;  // shade_: everything that casts shadows
    std::vector<const Thing*> seen_;                      // in the order of things_
    std::vector<Colour> albedo_;
    Colour cable_albedo_, ghost_albedo_, thing_albedo_, backdrop_top_, backdrop_bottom_;  // linear
    std::vector<double> floor_;
    int floor_columns_ = 0;
    std::vector<std::optional<Patch>> lights_;
    int light_columns_ = 0;
    Box3 window_;  ///< pixels, z unused
};

double Renderer::floor_shade(double x, double y) const {
    const Vec3 direction = ray(x, y);
    if (direction.z >= -1e-6) return 1;
    const double t = (scene_.floor_z_m - camera_.eye.z) / direction.z;
    if (t <= 0) return 1;
    const Vec3 lift{0, 0, 1e-4 * reach_};
    const Light light = lighting_.on_floor(shade_, camera_.eye + t * direction + lift);
    return 1 - floor_sky_shadow * (1 - light.sky) - floor_key_shadow * (1 - light.key);
}

/// Fills the cells between the corners of a square by interpolation, if the corners agree.
void Renderer::fill_floor_square(int row, int column) {
    constexpr int step = floor_cells_skipped;
    const double a = floor_cell(row, column), b = floor_cell(row, column + step);
    const double c = floor_cell(row + step, column), d = floor_cell(row + step, column + step);
    const auto [low, high] = std::minmax({a, b, c, d});
    const bool agree = high - low < floor_fine_contrast;
    for (int i = 0; i < step; ++i) {
        for (int j = 0; j < step; ++j) {
            const double u = static_cast<double>(j) / step, v = static_cast<double>(i) / step;
            if (i + j == 0) continue;
            if (agree)
                floor_cell(row + i, column + j) = (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * c + u * d);
            else
                shade_floor_cell(row + i, column + j);
        }
    }
}

/// Bilinear between the computed points or, where those differ much (a body touches the floor), computed exactly.
double Renderer::floor_at(double x, double y) const {
    const double column = x / floor_cell_px, row = y / floor_cell_px;
    const auto c = static_cast<std::size_t>(column), r = static_cast<std::size_t>(row);
    const double a = column - static_cast<double>(c), b = row - static_cast<double>(r);
    const auto value = [&](std::size_t i, std::size_t j) { return floor_[cell(floor_columns_, i, j)]; };
    const auto [low, high] = std::minmax({value(r, c), value(r, c + 1), value(r + 1, c), value(r + 1, c + 1)});
    if (high - low > floor_contrast) return floor_shade(x, y);
    return (1 - b) * ((1 - a) * value(r, c) + a * value(r, c + 1)) +
           b * ((1 - a) * value(r + 1, c) + a * value(r + 1, c + 1));
}

Light Renderer::patch_light(const Vec3& point, const Vec3& normal, const Vec3& geometric,
                            std::vector<Patch>& patches) const {
    for (const Patch& patch : patches) {
        if (is_same_patch(patch, point, normal)) return patch.light;
    }
    patches.push_back({point, normal, lighting_.at(shade_, point, normal, geometric)});
    return patches.back().light;
}

Colour Renderer::lit(const Colour& albedo, const Vec3& normal, const Vec3& direction, const Light& light) const {
    const Vec3 half = unit(lighting_.key_direction() - unit(direction));
    const double gloss = light.key > 0 ? 0.07 * std::pow(std::max(0.0, dot(normal, half)), 30) : 0.0;
    const double sky = bounced + (1 - bounced) * light.sky;
    const double full = sky_strength * sky + key_strength * light.key;
    return (1 + scene_.shading * (full - 1)) * albedo + scene_.shading * gloss * Colour{1, 1, 1};
}

/// Interpolated vertex quantity at a hit.
template <class T>
T at_hit(const std::vector<T>& values, const std::array<int, 3>& corners, const Hit& hit) {
    const auto value = [&](std::size_t k) { return values[static_cast<std::size_t>(corners[k])]; };
    return (1 - hit.u - hit.v) * value(0) + hit.u * value(1) + hit.v * value(2);
}

/// The geometric normal facing the viewer, and the smooth one on the same side of the surface.
std::array<Vec3, 2> seen_normals(const Pose& pose, const std::array<int, 3>& corners, const Hit& hit,
                                 const Vec3& direction) {
    Vec3 geometric = unit(hit.normal);
    if (dot(geometric, direction) > 0) geometric = -geometric;
    Vec3 normal = at_hit(pose.normals, corners, hit);
    normal = norm(normal) > 0 ? unit(normal) : geometric;
    if (dot(normal, geometric) < 0) normal = geometric;
    return {geometric, normal};
}

std::optional<Renderer::Patch> Renderer::light_through(double x, double y) const {
    if (!is_in_window(x, y)) return {};
    const Vec3 direction = ray(x, y);
    const Hit hit = body_.closest(camera_.eye, direction);
    if (!hit.found) return {};
    const auto [geometric, normal] =
        seen_normals(scene_.body, scene_.surface->triangles[hit.primitive], hit, direction);
    const Vec3 point = camera_.eye + hit.distance * direction;
    return Patch{point, normal, lighting_.at(shade_, point, normal, geometric)};
}

std::optional<Light> Renderer::smooth_light(double x, double y, const Vec3& point, const Vec3& normal) const {
    const double column = x / light_cell_px, row = y / light_cell_px;
    const auto c = static_cast<std::size_t>(column), r = static_cast<std::size_t>(row);
    const double a = column - static_cast<double>(c), b = row - static_cast<double>(r);
    const std::array<double, 4> shares = {(1 - b) * (1 - a), (1 - b) * a, b * (1 - a), b * a};
    Light sum{0, 0}, low{HUGE_VAL, HUGE_VAL}, high{0, 0};
    double share = 0;
    int found = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        const auto& corner = lights_[cell(light_columns_, r + k / 2, c + k % 2)];
        if (!corner || !is_same_patch(*corner, point, normal)) continue;
        const auto [sky, key] = corner->light;
        const double weight = shares[k] + 1e-6;
        sum = {sum.sky + weight * sky, sum.key + weight * key};
        low = {std::min(low.sky, sky), std::min(low.key, key)};
        high = {std::max(high.sky, sky), std::max(high.key, key)};
        share += weight;
        ++found;
    }
    if (found < 2 || high.sky - low.sky > light_contrast || high.key - low.key > light_contrast) return {};
    return Light{sum.sky / share, sum.key / share};
}

Colour Renderer::with_thing(const Colour& behind, const Hit& hit, const Vec3& direction, Shared& shared) const {
    const Thing& thing = *seen_[hit.geometry];
    const auto& corners = thing.surface->triangles[hit.primitive];
    const auto [geometric, normal] = seen_normals(thing.place, corners, hit, direction);
    const Vec3 point = camera_.eye + hit.distance * direction;
    const Light light = patch_light(point, normal, geometric, shared.thing_patches);
    const double sky = bounced + (1 - bounced) * light.sky;
    const Colour matte = (sky_strength * sky + key_strength * light.key) * thing_albedo_;
    return mix(behind, matte, at_hit(thing.opacity, corners, hit));
}

Colour Renderer::with_ghost(const Colour& behind, const Hit& hit, const Vec3& direction) const {
    const double facing = std::abs(dot(unit(hit.normal), unit(direction)));
    return mix(behind, ghost_albedo_, 0.13 + 0.24 * std::pow(1 - facing, 2));
}

Renderer::Sample Renderer::sample(double x, double y, Shared& shared) const {
    const Vec3 direction = ray(x, y);
    const Hit body = body_.closest(camera_.eye, direction);
    Vec3 body_normal;
    Colour colour;
    if (body.found) {
        const auto& corners = scene_.surface->triangles[body.primitive];
        const auto [geometric, normal] = seen_normals(scene_.body, corners, body, direction);
        const Vec3 point = camera_.eye + body.distance * direction;
        std::optional<Light> light = smooth_light(x, y, point, normal);
        if (!light) light = patch_light(point, normal, geometric, shared.patches);
        colour = lit(at_hit(albedo_, corners, body), normal, direction, *light);
        body_normal = normal;
    } else {
        if (!shared.floor) shared.floor = floor_at(x, y);
        colour = backdrop_colour(y, *shared.floor);
    }
    double depth = body.found ? body.distance : HUGE_VAL;
    const Hit ghost = scene_.ghost ? ghost_.closest(camera_.eye, direction) : Hit{};
    const bool has_ghost = ghost.found && ghost.distance + ghost_clearance * reach_ / norm(direction) < depth;
    const Hit thing = seen_.empty() ? Hit{} : things_.closest(camera_.eye, direction);
    const bool has_thing = thing.found && thing.distance < depth;
    const bool ghost_first = has_thing && has_ghost && ghost.distance < thing.distance;
    if (has_ghost && !ghost_first) colour = with_ghost(colour, ghost, direction);
    if (has_thing) {
        colour = with_thing(colour, thing, direction, shared);
        depth = thing.distance;
    }
    if (ghost_first) colour = with_ghost(colour, ghost, direction);
    const Hit cable = cables_.closest(camera_.eye, direction);
    if (cable.found) {
        Vec3 normal = unit(cable.normal);
        if (dot(normal, direction) > 0) normal = -normal;
        const Colour shaded = lit(cable_albedo_, normal, direction, lighting_.unshadowed(normal));
        colour = mix(colour, shaded, cable.distance < depth ? 1.0 : cable_behind);
    }
    const unsigned met =
        (body.found ? 1U : 0U) | (has_ghost ? 2U : 0U) | (has_thing ? 4U : 0U) | (cable.found ? 8U : 0U);
    return {colour, met, body_normal};
}

Colour Renderer::sampled_finely(int x, int y) const {
    Shared shared;
    Colour sum;
    for (int j = 0; j < samples_across; ++j) {
        for (int i = 0; i < samples_across; ++i) {
            // A rotated lattice: no two samples share a row or column, so near-axis edges get 16 grey levels.
            const double dx = (i + (j + 0.5) / samples_across) / samples_across,
                         dy = (j + (samples_across - 1 - i + 0.5) / samples_across) / samples_across;
            sum += sample(x + dx, y + dy, shared).colour;
        }
    }
    return to_srgb((1.0 / (samples_across * samples_across)) * sum);
}

Renderer::Sample Renderer::at_centre(int x, int y) const {
    Shared shared;
    Sample result = is_in_window(x + 0.5, y + 0.5)
                        ? sample(x + 0.5, y + 0.5, shared)
                        : Sample{backdrop_colour(y + 0.5, floor_at(x + 0.5, y + 0.5)), 0, {}};
    result.colour = to_srgb(result.colour);
    return result;
}

bool are_alike(const Colour& a, const Colour& b) {
    return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)}) < colour_contrast;
}

/// One ray per pixel and, where it differs from the surrounding pixels, many.
std::vector<Colour> Renderer::rows(int begin, int end) const {
    const int first = std::max(begin - 1, 0), last = std::min(end + 1, height_);
    std::vector<Sample> centres;
    for (int y = first; y < last; ++y) {
        for (int x = 0; x < width_; ++x) centres.push_back(at_centre(x, y));
    }
    const auto centre = [&](int x, int y) -> const Sample& {
        return centres[cell(width_, static_cast<std::size_t>(y - first), static_cast<std::size_t>(x))];
    };
    const auto is_like_its_neighbours = [&](int x, int y) {
        const Sample& own = centre(x, y);
        for (int j = std::max(y - 1, first); j < std::min(y + 2, last); ++j) {
            for (int i = std::max(x - 1, 0); i < std::min(x + 2, width_); ++i) {
                const Sample& other = centre(i, j);
                if (other.met != own.met || !are_alike(other.colour, own.colour)) return false;
                if ((own.met & 1U) != 0 && (i != x || j != y) && dot(other.normal, own.normal) < bend_contrast)
                    return false;
            }
        }
        return true;
    };
    std::vector<Colour> result;
    for (int y = begin; y < end; ++y) {
        for (int x = 0; x < width_; ++x)
            result.push_back(is_like_its_neighbours(x, y) ? centre(x, y).colour : sampled_finely(x, y));
    }
    return result;
}

std::uint8_t byte(double v) {
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(v, 0.0, 1.0)));
}

}  // namespace

Result<Image> render(const Scene& scene, const Camera& camera, int width_px, int height_px, const Progress& progress) {
    const EmbreeDevice device;
    if (Status status = device.status(); !status) return tl::unexpected(status.error());
    Renderer renderer(device, scene, camera, width_px, height_px);
    // If Embree ran out of memory, rays would pass through the scene.
    if (Status status = device.status(); !status) return tl::unexpected(status.error());
    renderer.prepare_floor(progress);
    renderer.prepare_light(progress);
    Image image{width_px, height_px, std::vector<std::uint8_t>(static_cast<std::size_t>(width_px * height_px) * 3)};
    parallel_for(static_cast<std::size_t>(height_px), rows_at_once, [&](std::size_t begin, std::size_t end) {
        if (progress.cancelled()) return;
        std::uint8_t* out = image.rgb.data() + begin * static_cast<std::size_t>(width_px) * 3;
        for (const Colour& c : renderer.rows(static_cast<int>(begin), static_cast<int>(end))) {
            *out++ = byte(c.r);
            *out++ = byte(c.g);
            *out++ = byte(c.b);
        }
    });
    if (progress.cancelled()) return cancelled();
    return image;
}

}  // namespace pliant::report
