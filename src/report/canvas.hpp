// Two-dimensional drawing over pictures: text, lines, boxes; and PNG. Cairo does the work.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.hpp"
#include "report/colour.hpp"
#include "report/raycast.hpp"

namespace pliant::report {

struct Point2 {
    double x = 0, y = 0;  ///< pixels from the top left corner
};

enum class Align { left, centre, right };

struct Font {
    double size_px = 22;
    Colour colour{0.16, 0.18, 0.22};
    Align align = Align::left;
    bool bold = false;
};

/// Colours are sRGB.
class Canvas {
public:
    Canvas(int width_px, int height_px, const Colour& background);
    Canvas(Canvas&&) noexcept;
    Canvas& operator=(Canvas&&) noexcept;
    ~Canvas();

    void image(const Image& image, int x, int y);
    /// `at` is on the baseline. Text that is not UTF-8 is shown with replacement characters.
    void text(const Point2& at, std::string_view text, const Font& font);
    [[nodiscard]] double text_width(std::string_view text, const Font& font) const;
    void line(std::span<const Point2> points, double width_px, const Colour& colour, double opacity = 1);
    void box(const Point2& corner, double width_px, double height_px, const Colour& colour, double radius_px = 0,
             double opacity = 1);
    void disc(const Point2& centre, double radius_px, const Colour& colour);

    /// 8-bit RGB.
    [[nodiscard]] Result<std::string> png() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Replaces what is not UTF-8 by U+FFFD and control characters by spaces.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace pliant::report
