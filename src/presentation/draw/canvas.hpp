// Two-dimensional drawing over pictures: text, lines, boxes; and PNG. Cairo does the work.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "presentation/draw/colour.hpp"
#include "presentation/draw/raycast.hpp"

namespace pliant::report {

struct Point2 {
    double x = 0, y = 0;  ///< from the top left corner
};

enum class Align { left, centre, right };

struct Font {
    double size = 22;
    Colour colour{0.16, 0.18, 0.22};
    Align align = Align::left;
    bool bold = false;
};

/// Coordinates are those of a picture 1000 units high, whatever its size in pixels, so that text and lines keep their
/// proportions. Colours are sRGB.
class Canvas {
public:
    /// An error if Cairo is not installed.
    [[nodiscard]] static Result<Canvas> create(int width_px, int height_px, const Colour& background);
    Canvas(Canvas&&) noexcept;
    Canvas& operator=(Canvas&&) noexcept;
    ~Canvas();

    [[nodiscard]] double width() const { return width_; }
    [[nodiscard]] double height() const { return 1000; }

    /// The only call in pixels; parts outside the canvas are clipped.
    void image(const Image& image, int x_px, int y_px);
    /// `at` is on the baseline. Text that is not UTF-8 is shown with replacement characters.
    void text(const Point2& at, std::string_view text, const Font& font);
    [[nodiscard]] double text_width(std::string_view text, const Font& font) const;
    void line(std::span<const Point2> points, double width, const Colour& colour, double opacity = 1);
    /// Fills a closed border.
    void area(std::span<const Point2> border, const Colour& colour, double opacity = 1);
    void box(const Point2& corner, double width, double height, const Colour& colour, double radius = 0,
             double opacity = 1);
    void disc(const Point2& centre, double radius, const Colour& colour);

    /// 8-bit RGB.
    [[nodiscard]] Result<std::string> png() const;
    [[nodiscard]] Image pixels() const;

private:
    struct State;
    Canvas();
    std::unique_ptr<State> state_;
    double width_ = 0;
};

/// Replaces invalid UTF-8 by U+FFFD and control characters by spaces.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace pliant::report
