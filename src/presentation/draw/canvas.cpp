#include "presentation/draw/canvas.hpp"

#include <cmath>
#include <numbers>

#include "base/core/utf8.hpp"
#include "presentation/draw/cairo_library.hpp"

namespace pliant::report {

struct Canvas::State {
    CairoLibrary cairo;
    std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> owned_surface{nullptr, cairo.surface_destroy};
    std::unique_ptr<cairo_t, decltype(&cairo_destroy)> owned_context{nullptr, cairo.destroy};

    [[nodiscard]] cairo_surface_t* surface() const { return owned_surface.get(); }
    [[nodiscard]] cairo_t* context() const { return owned_context.get(); }
    /// Selects the font, and returns the width of the text in it.
    [[nodiscard]] double advance_width(const std::string& text, const Font& font) const;
};

double Canvas::State::advance_width(const std::string& text, const Font& font) const {
    cairo.select_font_face(context(), "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                           font.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo.set_font_size(context(), font.size);
    cairo_text_extents_t extents;
    cairo.text_extents(context(), text.c_str(), &extents);
    return extents.x_advance;
}

namespace {

cairo_status_t append_png(void* out, const unsigned char* data, unsigned int length) {
    static_cast<std::string*>(out)->append(reinterpret_cast<const char*>(data), length);
    return CAIRO_STATUS_SUCCESS;
}

}  // namespace

std::string printable(std::string_view text) {
    std::string out;
    while (!text.empty()) {
        const std::size_t length = utf8_length(text);
        if (length == 0)
            out += "\xef\xbf\xbd";
        else if (length == 1 && (static_cast<unsigned char>(text[0]) < 0x20 || text[0] == 0x7f))
            out += ' ';
        else
            out += text.substr(0, length);
        text.remove_prefix(length == 0 ? 1 : length);
    }
    return out;
}

Result<Canvas> Canvas::create(int width_px, int height_px, const Colour& background) {
    Canvas canvas;
    State& state = *canvas.state_;
    const CairoLibrary& cairo = state.cairo;
    if (!cairo.is_there()) return failure("pictures: the library {} is not installed", cairo.name());
    state.owned_surface.reset(cairo.image_surface_create(CAIRO_FORMAT_RGB24, width_px, height_px));
    state.owned_context.reset(cairo.create(state.surface()));
    cairo.set_source_rgb(state.context(), background.r, background.g, background.b);
    cairo.paint(state.context());
    const double scale = height_px / canvas.height();
    cairo.scale(state.context(), scale, scale);
    canvas.width_ = width_px / scale;
    return canvas;
}

Canvas::Canvas() : state_(std::make_unique<State>()) {}
Canvas::Canvas(Canvas&&) noexcept = default;
Canvas& Canvas::operator=(Canvas&&) noexcept = default;
Canvas::~Canvas() = default;

void Canvas::image(const Image& image, int x_px, int y_px) {
    const CairoLibrary& cairo = state_->cairo;
    cairo_surface_t* surface = state_->surface();
    cairo.surface_flush(surface);
    unsigned char* pixels = cairo.image_surface_get_data(surface);
    if (pixels == nullptr) return;
    const int stride = cairo.image_surface_get_stride(surface);
    const int rows = std::min(image.height_px, cairo.image_surface_get_height(surface) - y_px);
    const int columns = std::min(image.width_px, cairo.image_surface_get_width(surface) - x_px);
    for (int j = 0; j < rows; ++j) {
        const std::uint8_t* in =
            image.rgb.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(image.width_px) * 3;
        auto* out = reinterpret_cast<std::uint32_t*>(pixels + static_cast<std::ptrdiff_t>(y_px + j) * stride) + x_px;
        for (int i = 0; i < columns; ++i, in += 3) {
            *out++ = static_cast<std::uint32_t>(in[0]) << 16 | static_cast<std::uint32_t>(in[1]) << 8 | in[2];
        }
    }
    cairo.surface_mark_dirty(surface);
}

void Canvas::text(const Point2& at, std::string_view text, const Font& font) {
    const CairoLibrary& cairo = state_->cairo;
    cairo_t* context = state_->context();
    const std::string shown = printable(text);
    const double width = state_->advance_width(shown, font);
    const double shift = font.align == Align::left ? 0 : font.align == Align::centre ? width / 2 : width;
    cairo.set_source_rgb(context, font.colour.r, font.colour.g, font.colour.b);
    cairo.move_to(context, at.x - shift, at.y);
    cairo.show_text(context, shown.c_str());
}

double Canvas::text_width(std::string_view text, const Font& font) const {
    return state_->advance_width(printable(text), font);
}

void Canvas::line(std::span<const Point2> points, double width, const Colour& colour, double opacity) {
    const CairoLibrary& cairo = state_->cairo;
    cairo_t* context = state_->context();
    cairo.new_path(context);
    for (const Point2& p : points) cairo.line_to(context, p.x, p.y);
    cairo.set_line_width(context, width);
    cairo.set_line_cap(context, CAIRO_LINE_CAP_ROUND);
    cairo.set_line_join(context, CAIRO_LINE_JOIN_ROUND);
    cairo.set_source_rgba(context, colour.r, colour.g, colour.b, opacity);
    cairo.stroke(context);
}

void Canvas::area(std::span<const Point2> border, const Colour& colour, double opacity) {
    const CairoLibrary& cairo = state_->cairo;
    cairo_t* context = state_->context();
    cairo.new_path(context);
    for (const Point2& p : border) cairo.line_to(context, p.x, p.y);
    cairo.close_path(context);
    cairo.set_source_rgba(context, colour.r, colour.g, colour.b, opacity);
    cairo.fill(context);
}

void Canvas::box(const Point2& corner, double width, double height, const Colour& colour, double radius,
                 double opacity) {
    const CairoLibrary& cairo = state_->cairo;
    cairo_t* context = state_->context();
    const double quarter = std::numbers::pi / 2, left = corner.x + radius, right = corner.x + width - radius;
    const double top = corner.y + radius, bottom = corner.y + height - radius;
    cairo.new_path(context);
    cairo.arc(context, right, top, radius, -quarter, 0);
    cairo.arc(context, right, bottom, radius, 0, quarter);
    cairo.arc(context, left, bottom, radius, quarter, 2 * quarter);
    cairo.arc(context, left, top, radius, 2 * quarter, 3 * quarter);
    cairo.close_path(context);
    cairo.set_source_rgba(context, colour.r, colour.g, colour.b, opacity);
    cairo.fill(context);
}

void Canvas::disc(const Point2& centre, double radius, const Colour& colour) {
    const CairoLibrary& cairo = state_->cairo;
    cairo_t* context = state_->context();
    cairo.new_path(context);
    cairo.arc(context, centre.x, centre.y, radius, 0, 2 * std::numbers::pi);
    cairo.set_source_rgb(context, colour.r, colour.g, colour.b);
    cairo.fill(context);
}

Image Canvas::pixels() const {
    const CairoLibrary& cairo = state_->cairo;
    cairo_surface_t* surface = state_->surface();
    cairo.surface_flush(surface);
    Image image{cairo.image_surface_get_width(surface), cairo.image_surface_get_height(surface), {}};
    const unsigned char* rows = cairo.image_surface_get_data(surface);
    const int stride = cairo.image_surface_get_stride(surface);
    image.rgb.reserve(static_cast<std::size_t>(image.width_px) * static_cast<std::size_t>(image.height_px) * 3);
    for (int j = 0; j < image.height_px; ++j) {
        const auto* row = reinterpret_cast<const std::uint32_t*>(rows + static_cast<std::ptrdiff_t>(j) * stride);
        for (int i = 0; i < image.width_px; ++i) {
            for (const int shift : {16, 8, 0}) image.rgb.push_back(static_cast<std::uint8_t>(row[i] >> shift));
        }
    }
    return image;
}

Result<std::string> Canvas::png() const {
    std::string bytes;
    const cairo_status_t code = state_->cairo.surface_write_to_png_stream(state_->surface(), &append_png, &bytes);
    if (code != CAIRO_STATUS_SUCCESS) return failure("picture: {}", state_->cairo.status_to_string(code));
    return bytes;
}

}  // namespace pliant::report
