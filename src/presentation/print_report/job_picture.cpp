#include "presentation/print_report/job_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "presentation/draw/canvas.hpp"
#include "presentation/print_report/material_colours.hpp"
#include "presentation/print_report/picture_colours.hpp"
#include "printing/slice/run_image.hpp"

namespace pliant::report {
namespace {

constexpr int job_width_px = 1600, job_height_px = 1000;
constexpr Colour dark{0.11, 0.12, 0.15};
constexpr int shown_layers = 4;
constexpr int sheet_columns = 6, sheet_rows = 4;

/// The range of pixels lit by any layer.
struct Extent {
    int left = INT32_MAX, right = 0, top = INT32_MAX, bottom = 0;
    [[nodiscard]] int width() const { return right - left; }
    [[nodiscard]] int height() const { return bottom - top; }
};

struct Shot {
    int material = 0;
    slice::RunImage image;
};

/// Everything drawn of a job.
struct Views {
    Extent extent;
    std::vector<Colour> colours;            ///< of the materials
    std::vector<std::vector<Shot>> layers;  ///< those shown from above
    std::vector<int> numbers;               ///< their layer numbers, from 0
    /// Per layer, per material: brightness of every column, summed over the rows.
    std::vector<std::vector<std::vector<std::int64_t>>> columns;
};

void grow(Extent& extent, const slice::RunImage& image) {
    if (image.blank()) return;
    extent.top = std::min(extent.top, image.first_row());
    extent.bottom = std::max(extent.bottom, image.end_row());
    for (int row = image.first_row(); row < image.end_row(); ++row) {
        if (image.row(row).empty()) continue;
        extent.left = std::min<int>(extent.left, image.row(row).front().begin);
        extent.right = std::max<int>(extent.right, image.row(row).back().end);
    }
}

std::vector<std::int64_t> column_light(const slice::RunImage& image) {
    std::vector<std::int64_t> light(static_cast<std::size_t>(image.width_px()) + 1, 0);
    for (int row = image.first_row(); row < image.end_row(); ++row) {
        for (const slice::Run& run : image.row(row)) {
            light[run.begin] += run.value;
            light[run.end] -= run.value;
        }
    }
    for (std::size_t c = 1; c < light.size(); ++c) light[c] += light[c - 1];
    return light;
}

Result<Views> look(const job::Archive& archive, int most_shown) {
    const job::Manifest& m = archive.manifest();
    Views views;
    views.colours = material_colours(m);
    job::Image image;
    const int count = static_cast<int>(m.layers.size()), shown_count = std::min(most_shown, count);
    for (int i = 0; i < shown_count; ++i) views.numbers.push_back(static_cast<int>((i + 0.5) * count / shown_count));
    for (int k = 0; k < count; ++k) {
        auto& columns = views.columns.emplace_back(m.materials.size());
        const bool shown = std::find(views.numbers.begin(), views.numbers.end(), k) != views.numbers.end();
        if (shown) views.layers.emplace_back();
        for (const job::LayerImage& entry : m.layers[static_cast<std::size_t>(k)].images) {
            if (Status status = archive.image(entry.file, image); !status) return tl::unexpected(status.error());
            slice::RunImage runs = slice::RunImage::from_image(image);
            grow(views.extent, runs);
            columns[static_cast<std::size_t>(entry.material)] = column_light(runs);
            if (shown) views.layers.back().push_back({entry.material, std::move(runs)});
        }
    }
    if (views.extent.width() <= 0) return input_error("{}: no layer is lit", m.name);
    return views;
}

/// A picture filled pixel by pixel, at `scale` picture pixels per image pixel.
template <class ColourAt>
Image paint(int width, int height, const ColourAt& colour_at) {
    Image image{width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(width) * height * 3)};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const Colour c = colour_at(x, y);
            std::uint8_t* p = image.rgb.data() + 3 * (static_cast<std::size_t>(y) * width + x);
            p[0] = static_cast<std::uint8_t>(std::lround(255 * c.r));
            p[1] = static_cast<std::uint8_t>(std::lround(255 * c.g));
            p[2] = static_cast<std::uint8_t>(std::lround(255 * c.b));
        }
    }
    return image;
}

Colour colour_of_layer(const std::vector<Colour>& colours, const std::vector<Shot>& shots, int row, int column) {
    for (const Shot& shot : shots) {
        if (const int value = shot.image.at(row, column); value > 0)
            return mix(dark, colours[static_cast<std::size_t>(shot.material)], value / 255.0);
    }
    return dark;
}

/// From the front: the material with most of the light in a column of a layer.
Colour colour_of_front(const Views& views, int layer, int column) {
    const auto& materials = views.columns[static_cast<std::size_t>(layer)];
    int owner = -1;
    std::int64_t most = 0;
    for (std::size_t m = 0; m < materials.size(); ++m) {
        if (materials[m].empty() || materials[m][static_cast<std::size_t>(column)] <= most) continue;
        most = materials[m][static_cast<std::size_t>(column)];
        owner = static_cast<int>(m);
    }
    return owner < 0 ? dark : views.colours[static_cast<std::size_t>(owner)];
}

void draw_front(Canvas& canvas, const Views& views, const job::Manifest& m) {
    const double wide_mm = views.extent.width() * m.pixel_um / 1000, high_mm = m.layers.back().z_um / 1000.0;
    const double scale = std::min(640 / wide_mm, 760 / high_mm);
    const int w = std::max(1, static_cast<int>(wide_mm * scale)), h = std::max(1, static_cast<int>(high_mm * scale));
    const int count = static_cast<int>(m.layers.size());
    canvas.image(paint(w, h,
                       [&](int x, int y) {
                           const int layer = count - 1 - static_cast<int>((y + 0.5) / h * count);
                           const int column =
                               views.extent.left + static_cast<int>((x + 0.5) / w * views.extent.width());
                           return colour_of_front(views, std::clamp(layer, 0, count - 1), column);
                       }),
                 60, 160);
    canvas.text({60, 145}, fmt::format("from the front, {:.4g} x {:.4g} mm", wide_mm, high_mm),
                {.size = 22, .colour = ink});
}

void draw_layers(Canvas& canvas, const Views& views, const job::Manifest& m) {
    const Extent& e = views.extent;
    const double scale = std::min(740.0 / e.width(), 160.0 / e.height());
    const int w = std::max(1, static_cast<int>(e.width() * scale)),
              h = std::max(1, static_cast<int>(e.height() * scale));
    for (std::size_t i = 0; i < views.layers.size(); ++i) {
        const int y = 160 + static_cast<int>(i) * 205;
        canvas.image(paint(w, h,
                           [&](int px, int py) {
                               return colour_of_layer(views.colours, views.layers[i],
                                                      e.top + static_cast<int>((py + 0.5) / scale),
                                                      e.left + static_cast<int>((px + 0.5) / scale));
                           }),
                     780, y);
        const int z_um = m.layers[static_cast<std::size_t>(views.numbers[i])].z_um;
        canvas.text({780, y - 15.0}, fmt::format("layer {}, up to {:.2f} mm", views.numbers[i] + 1, z_um / 1000.0),
                    {.size = 22, .colour = ink});
    }
}

}  // namespace

namespace {

/// In rows from the top left, each with its number and height.
void draw_sheet(Canvas& canvas, const Views& views, const job::Manifest& m) {
    const Extent& e = views.extent;
    const int cell_w = job_width_px / sheet_columns, cell_h = job_height_px / sheet_rows;
    const double scale = std::min((cell_w - 24.0) / e.width(), (cell_h - 48.0) / e.height());
    const int w = std::max(1, static_cast<int>(e.width() * scale)),
              h = std::max(1, static_cast<int>(e.height() * scale));
    for (std::size_t i = 0; i < views.layers.size(); ++i) {
        const int x = static_cast<int>(i) % sheet_columns * cell_w + 12,
                  y = static_cast<int>(i) / sheet_columns * cell_h + 34;
        canvas.image(paint(w, h,
                           [&](int px, int py) {
                               return colour_of_layer(views.colours, views.layers[i],
                                                      e.top + static_cast<int>((py + 0.5) / scale),
                                                      e.left + static_cast<int>((px + 0.5) / scale));
                           }),
                     x, y);
        const int z_um = m.layers[static_cast<std::size_t>(views.numbers[i])].z_um;
        canvas.text({static_cast<double>(x), y - 9.0},
                    fmt::format("layer {}, {:.2f} mm", views.numbers[i] + 1, z_um / 1000.0),
                    {.size = 19, .colour = ink});
    }
}

}  // namespace

Result<std::string> layers_picture(const job::Archive& archive) {
    const auto views = look(archive, sheet_columns * sheet_rows);
    if (!views) return tl::unexpected(views.error());
    auto made = Canvas::create(job_width_px, job_height_px, paper);
    if (!made) return tl::unexpected(made.error());
    Canvas& canvas = *made;
    draw_sheet(canvas, *views, archive.manifest());
    return canvas.png();
}

Result<std::string> job_picture(const job::Archive& archive) {
    const auto views = look(archive, shown_layers);
    if (!views) return tl::unexpected(views.error());
    const job::Manifest& m = archive.manifest();
    auto made = Canvas::create(job_width_px, job_height_px, paper);
    if (!made) return tl::unexpected(made.error());
    Canvas& canvas = *made;
    canvas.text({60, 62}, m.name, {.size = 34, .colour = ink, .bold = true});
    double x = 60;
    for (std::size_t i = 0; i < m.materials.size(); ++i) {
        const std::string name = fmt::format("{} ({:.1f} mm³)", m.materials[i].name, m.materials[i].model_volume_mm3);
        const Font font{.size = 22, .colour = ink};
        canvas.box({x, 82}, 20, 20, views->colours[i], 3);
        canvas.text({x + 30, 100}, name, font);
        x += 70 + canvas.text_width(name, font);
    }
    draw_front(canvas, *views, m);
    draw_layers(canvas, *views, m);
    return canvas.png();
}

}  // namespace pliant::report
