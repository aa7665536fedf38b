#include "presentation/print_report/wash_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "presentation/draw/camera.hpp"
#include "presentation/draw/canvas.hpp"
#include "presentation/draw/raycast.hpp"
#include "presentation/print_report/picture_colours.hpp"

namespace pliant::report {
namespace {

constexpr int wash_width_px = 1600, wash_height_px = 800, wash_title_px = 130;
constexpr Colour fixed{0.62, 0.64, 0.68};  // faces on the platform: they are not sprayed
constexpr Colour clean{0.80, 0.87, 0.91}, halfway{0.95, 0.74, 0.38}, wet{0.72, 0.13, 0.16};

Colour colour_of_resin_left(double left) {
    return left < 0.5 ? mix(clean, halfway, 2 * left) : mix(halfway, wet, 2 * left - 1);
}

struct Skin {
    Surface surface;
    Pose place;
    std::vector<Colour> colours;
};

/// Sides of cells as a surface, in metres; rotated about x so that the side of the jets or of the platform is up.
class SkinMaker {
public:
    SkinMaker(const wash::PartCells& part, bool from_platform)
        : size_{part.cell_mm, part.cell_mm, part.high_mm}, from_platform_(from_platform) {}

    void add(const wash::Face& face, const Colour& colour) {
        std::array<Vec3, 2> half{};
        std::size_t k = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            if (face.axis[i] == 0) half[k++][i] = size_[i] / 2;
        }
        const int first = static_cast<int>(skin_.place.positions.size());
        for (const auto& [u, v] : {std::array{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
            skin_.place.positions.push_back(turned(face.middle + u * half[0] + v * half[1]));
            skin_.place.normals.push_back(unit(turned(face.normal)));
            skin_.colours.push_back(colour);
            skin_.surface.vertex_node.push_back(0);
        }
        const bool inwards = dot(cross(half[0], half[1]), face.axis) < 0;
        for (const auto& t : {std::array{0, 1, 2}, {0, 2, 3}}) {
            skin_.surface.triangles.push_back({first + t[0], first + t[inwards ? 2 : 1], first + t[inwards ? 1 : 2]});
            skin_.surface.material.push_back(0);
            skin_.surface.tet.push_back(-1);
        }
    }
    [[nodiscard]] Skin made() { return std::move(skin_); }

private:
    [[nodiscard]] Vec3 turned(const Vec3& mm) const {
        const Vec3 m = 1e-3 * mm;
        return from_platform_ ? m : Vec3{m.x, -m.y, -m.z};
    }

    std::array<double, 3> size_;
    bool from_platform_;
    Skin skin_;
};

Skin skin_of(const wash::PartCells& part, const std::vector<wash::Face>& faces, const std::vector<double>& left,
             bool from_platform) {
    SkinMaker maker(part, from_platform);
    for (std::size_t f = 0; f < faces.size(); ++f) maker.add(faces[f], colour_of_resin_left(left[f]));
    constexpr Vec3 up{0, 0, 1};
    for (int row = 0; row < part.rows; ++row) {
        for (int column = 0; column < part.columns; ++column) {
            if (!part.at(column, row, 0)) continue;
            const Vec3 middle{part.x_mm + (column + 0.5) * part.cell_mm, part.y_mm + (row + 0.5) * part.cell_mm, 0};
            maker.add({middle, up, up, 0}, fixed);
        }
    }
    return maker.made();
}

Result<Image> view_of(const Skin& skin, int wide, int high) {
    Scene scene;
    scene.surface = &skin.surface;
    scene.body = skin.place;
    scene.vertex_colours = skin.colours;
    scene.floor_z_m = -1e3;
    scene.shading = 0.6;
    scene.backdrop_top = scene.backdrop_bottom = paper;
    const std::vector<Vec3>& points = skin.place.positions;
    const Camera camera =
        fitted(choose_view(points, {}), points, static_cast<double>(wide) / high, {0.08, 0.08, 0.08, 0.08});
    return render(scene, camera, wide, high, Progress{});
}

/// The colour scale, at the right of the heading.
void draw_scale(Canvas& canvas) {
    constexpr double x = 1180, y = 34, step = 12;
    constexpr int steps = 30;
    for (int i = 0; i < steps; ++i)
        canvas.box({x + i * step, y}, step + 1, 26, colour_of_resin_left((i + 0.5) / steps));
    const Font font{.size = 19, .colour = ink, .align = Align::centre};
    canvas.text({x, y + 50}, "0", font);
    canvas.text({x + steps * step / 2.0, y + 50}, "share of the film that stays", font);
    canvas.text({x + steps * step, y + 50}, "1", font);
}

}  // namespace

Result<std::string> wash_picture(std::string_view title, const wash::PartCells& part,
                                 const std::vector<wash::Face>& faces, const wash::Cleanness& cleanness) {
    if (faces.empty()) return input_error("{}: nothing is printed, so there is nothing to clean", title);
    auto made = Canvas::create(wash_width_px, wash_height_px, paper);
    if (!made) return tl::unexpected(made.error());
    Canvas& canvas = *made;
    for (const bool from_platform : {false, true}) {
        const int wide = wash_width_px / 2, high = wash_height_px - wash_title_px;
        const Result<Image> image = view_of(skin_of(part, faces, cleanness.left, from_platform), wide, high);
        if (!image) return tl::unexpected(image.error());
        canvas.image(*image, from_platform ? wide : 0, wash_title_px);
    }
    canvas.text({60, 62}, title, {.size = 32, .colour = ink, .bold = true});
    canvas.text({60, 98},
                fmt::format("{:.1f} % of the film is removed; no spray reaches {:.1f} % of the surface",
                            100 * cleanness.removed, 100 * cleanness.unseen),
                {.size = 22, .colour = ink});
    draw_scale(canvas);
    canvas.text({60, 158}, "from the jets' side", {.size = 22, .colour = ink, .bold = true});
    canvas.text({860, 158}, "from the platform's side", {.size = 22, .colour = ink, .bold = true});
    return canvas.png();
}

}  // namespace pliant::report
