// Pictures of the cured block: cells become a surface, which is ray-cast.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "presentation/draw/camera.hpp"
#include "presentation/draw/canvas.hpp"
#include "presentation/draw/raycast.hpp"
#include "presentation/print_report/cured_block.hpp"
#include "presentation/print_report/material_colours.hpp"
#include "presentation/print_report/picture_colours.hpp"

namespace pliant::report {
namespace {

using twin::CoarsePart;

constexpr int block_width_px = 1200, block_height_px = 540, block_title_px = 64;
constexpr Colour surplus_colour{0.52, 0.04, 0.10}, missing_colour{0.94, 0.36, 0.50};  // different from all materials
constexpr double seen_through = 0.22;

/// Cells as a surface with flat faces, in metres; up is away from the platform, as in the job.
struct Cells {
    Surface surface;
    Pose place;
    std::vector<Colour> colours;  ///< of the vertices
};

using ColourOf = std::function<Colour(int material)>;

class BlockSkin {
public:
    BlockSkin(const CoarsePart& part, const machine::Projector& projector, ColourOf colour)
        : part_(part),
          colour_(std::move(colour)),
          cell_m_(part.cell_px() * projector.pixel_um * 1e-6),
          right_(projector.mirror_x ? -1 : 1),
          down_(projector.mirror_y ? 1 : -1) {}

    Cells made() {
        const auto& slabs = part_.slabs();
        const Grid nothing;
        Grid below, here = grid_of(0);
        for (std::size_t s = 0; s < slabs.size(); ++s) {
            Grid next = grid_of(s + 1);
            const bool touching = s + 1 < slabs.size() && slabs[s + 1].bottom_um <= slabs[s].top_um;
            for (std::size_t r = slabs[s].first; r < end_of(s); ++r)
                add(part_.runs()[r], below, here, touching ? next : nothing);
            below = touching ? std::move(here) : Grid();
            here = std::move(next);
        }
        return std::move(cells_);
    }

private:
    using Grid = std::vector<char>;  ///< (rows, columns), 1: solid; empty: no solid cells

    [[nodiscard]] std::size_t end_of(std::size_t slab) const {
        return slab + 1 < part_.slabs().size() ? part_.slabs()[slab + 1].first : part_.runs().size();
    }
    [[nodiscard]] std::size_t at(int row, int column) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(part_.columns()) +
               static_cast<std::size_t>(column);
    }
    [[nodiscard]] Grid grid_of(std::size_t slab) const {
        Grid grid(static_cast<std::size_t>(part_.rows()) * static_cast<std::size_t>(part_.columns()));
        if (slab >= part_.slabs().size()) return grid;
        for (std::size_t r = part_.slabs()[slab].first; r < end_of(slab); ++r) {
            const CoarsePart::CellRun& run = part_.runs()[r];
            for (int c = run.begin; c < run.end; ++c) grid[at(run.row, c)] = 1;
        }
        return grid;
    }
    [[nodiscard]] bool solid(const Grid& grid, int row, int column) const {
        if (grid.empty() || row < 0 || column < 0 || row >= part_.rows() || column >= part_.columns()) return false;
        return grid[at(row, column)] != 0;
    }
    [[nodiscard]] double x(int column) const { return right_ * (column - part_.columns() / 2.0) * cell_m_; }
    [[nodiscard]] double y(int row) const { return down_ * (row - part_.rows() / 2.0) * cell_m_; }

    /// A face over all cells of a run from `begin` to `end`, with this normal.
    void quad(const std::array<Vec3, 4>& corners, const Vec3& normal, const Colour& colour) {
        const int first = static_cast<int>(cells_.place.positions.size());
        for (const Vec3& corner : corners) {
            cells_.place.positions.push_back(corner);
            cells_.place.normals.push_back(normal);
            cells_.colours.push_back(colour);
            cells_.surface.vertex_node.push_back(0);
        }
        const bool turned = dot(cross(corners[1] - corners[0], corners[3] - corners[0]), normal) < 0;
        for (const std::array<int, 3>& t : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
            cells_.surface.triangles.push_back({first + t[0], first + t[turned ? 2 : 1], first + t[turned ? 1 : 2]});
            cells_.surface.material.push_back(0);
            cells_.surface.tet.push_back(-1);
        }
    }

    /// Faces along the run, in maximal uncovered pieces.
    void along(const CoarsePart::CellRun& run, const std::function<bool(int column)>& covered,
               const std::function<void(int begin, int end)>& face) {
        for (int c = run.begin; c < run.end;) {
            const int begin = c;
            const bool hidden = covered(c);
            while (c < run.end && covered(c) == hidden) ++c;
            if (!hidden) face(begin, c);
        }
    }

    void add(const CoarsePart::CellRun& run, const Grid& below, const Grid& here, const Grid& above) {
        const CoarsePart::Slab& slab = part_.slabs()[run.slab];
        const double z0 = slab.bottom_um * 1e-6, z1 = slab.top_um * 1e-6;
        const Colour colour = colour_(run.material);
        const double y0 = y(run.row), y1 = y(run.row + 1);
        for (const bool top : {false, true}) {
            const double z = top ? z1 : z0;
            along(
                run, [&](int c) { return solid(top ? above : below, run.row, c); },
                [&](int b, int e) {
                    quad({Vec3{x(b), y0, z}, {x(e), y0, z}, {x(e), y1, z}, {x(b), y1, z}}, {0, 0, top ? 1.0 : -1.0},
                         colour);
                });
        }
        for (const int side : {-1, 1}) {
            const double at_y = side < 0 ? y0 : y1;
            along(
                run, [&](int c) { return solid(here, run.row + side, c); },
                [&](int b, int e) {
                    quad({Vec3{x(b), at_y, z0}, {x(e), at_y, z0}, {x(e), at_y, z1}, {x(b), at_y, z1}},
                         {0, down_ * side, 0}, colour);
                });
        }
        for (const bool far : {false, true}) {
            const int column = far ? run.end : run.begin - 1;
            if (solid(here, run.row, column)) continue;
            const double at_x = x(far ? run.end : run.begin);
            quad({Vec3{at_x, y0, z0}, {at_x, y1, z0}, {at_x, y1, z1}, {at_x, y0, z1}}, {far ? right_ : -right_, 0, 0},
                 colour);
        }
    }

    const CoarsePart& part_;
    ColourOf colour_;
    double cell_m_, right_, down_;
    Cells cells_;
};

Colour off_colour(int kind) {
    return kind == 0 ? surplus_colour : missing_colour;
}

/// One camera for all bodies, so that they can be compared.
Camera camera_for(const std::vector<Vec3>& points, double aspect) {
    return fitted(choose_view(points, {}), points, aspect, {0.05, 0.05, 0.06, 0.06});
}

Result<Image> view_of_cells(const Cells& cells, const Cells* shade, const Camera& camera, double floor_m, int wide,
                            int high) {
    Scene scene;
    scene.surface = &cells.surface;
    scene.body = cells.place;
    scene.vertex_colours = cells.colours;
    scene.floor_z_m = floor_m;
    scene.backdrop_top = scene.backdrop_bottom = paper;
    if (shade != nullptr) {
        std::vector<double> opacity(shade->place.positions.size(), seen_through);
        scene.things.push_back({&shade->surface, shade->place, std::move(opacity), false});
    }
    return render(scene, camera, wide, high, Progress{});
}

}  // namespace

Result<std::string> block_picture(const CuredBlock& block, const job::Manifest& job,
                                  const machine::Projector& projector) {
    const std::vector<Colour> colours = material_colours(job);
    const auto material_colour = [&](int material) { return colours[static_cast<std::size_t>(material)]; };
    const Cells asked = BlockSkin(block.asked, projector, material_colour).made();
    if (asked.place.positions.empty()) return input_error("{}: no layer is lit", job.name);
    const Cells cured = BlockSkin(block.cured, projector, material_colour).made();
    const Cells off = BlockSkin(block.off, projector, off_colour).made();
    std::vector<Vec3> points = asked.place.positions;
    points.insert(points.end(), cured.place.positions.begin(), cured.place.positions.end());
    points.insert(points.end(), off.place.positions.begin(), off.place.positions.end());

    const bool differs = !off.place.positions.empty();
    const int columns = differs ? 3 : 2;
    const int wide = block_width_px / columns, high = block_height_px - block_title_px;
    const Camera camera = camera_for(points, static_cast<double>(wide) / high);
    auto made = Canvas::create(block_width_px, block_height_px, paper);
    if (!made) return tl::unexpected(made.error());
    Canvas& canvas = *made;
    const double unit = 1000.0 / block_height_px;  // the canvas is 1000 units high
    const auto title = [&](int column, const std::string& text, const Colour* swatch) {
        const double x = (column * wide + 40) * unit;
        if (swatch != nullptr) canvas.box({x, 40}, 24, 24, *swatch, 4);
        canvas.text({x + (swatch != nullptr ? 36 : 0), 62}, text, {28, {0.16, 0.18, 0.22}, Align::left, true});
    };
    const std::array<const Cells*, 3> bodies = {&asked, &cured, &off};
    for (int c = 0; c < columns; ++c) {
        const Cells& cells = *bodies[static_cast<std::size_t>(c)];
        if (cells.place.positions.empty() || (c == 0 && !differs)) continue;
        const Result<Image> image = view_of_cells(cells, c == 2 ? &asked : nullptr, camera, 0, wide, high);
        if (!image) return tl::unexpected(image.error());
        canvas.image(*image, c * wide, block_title_px);
        if (!differs) canvas.image(*image, 0, block_title_px);  // the drawing looks the same
    }
    title(0, "as drawn", nullptr);
    title(1, cured.place.positions.empty() ? "nothing has cured" : "as it has cured", nullptr);
    if (differs) {
        title(2, "too much, or another resin", &surplus_colour);
        const double x = (2 * wide + 40) * unit;
        canvas.box({x, 78}, 24, 24, missing_colour, 4);
        canvas.text({x + 36, 100}, "missing", {28, {0.16, 0.18, 0.22}, Align::left, true});
    }
    return canvas.png();
}

}  // namespace pliant::report
