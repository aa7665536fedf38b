#include "presentation/draw/colour.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace pliant::report {
namespace {

double channel_to_linear(double v) {
    v = std::clamp(v, 0.0, 1.0);
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

double channel_to_srgb(double v) {
    v = std::clamp(v, 0.0, 1.0);
    return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
}

/// OKLab to linear sRGB, unclamped.
Colour oklab_to_linear(double lightness, double a, double b) {
    const double l = std::pow(lightness + 0.3963377774 * a + 0.2158037573 * b, 3);
    const double m = std::pow(lightness - 0.1055613458 * a - 0.0638541728 * b, 3);
    const double s = std::pow(lightness - 0.0894841775 * a - 1.2914855480 * b, 3);
    return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
            -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
            -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

}  // namespace

Colour to_linear(const Colour& srgb) {
    return {channel_to_linear(srgb.r), channel_to_linear(srgb.g), channel_to_linear(srgb.b)};
}

Colour to_srgb(const Colour& linear) {
    return {channel_to_srgb(linear.r), channel_to_srgb(linear.g), channel_to_srgb(linear.b)};
}

std::string hex(const Colour& srgb) {
    const auto byte = [](double v) { return static_cast<int>(std::lround(255 * std::clamp(v, 0.0, 1.0))); };
    return fmt::format("#{:02x}{:02x}{:02x}", byte(srgb.r), byte(srgb.g), byte(srgb.b));
}

Colour colour_of_hex(const std::string& text) {
    const auto channel = [&](std::size_t at) { return std::stoi(text.substr(at, 2), nullptr, 16) / 255.0; };
    return {channel(1), channel(3), channel(5)};
}

Colour palette(int index) {
    static constexpr std::array<Colour, 8> colours = {{{0.20, 0.45, 0.70},
                                                       {0.93, 0.58, 0.22},
                                                       {0.22, 0.62, 0.52},
                                                       {0.78, 0.40, 0.58},
                                                       {0.56, 0.75, 0.89},
                                                       {0.90, 0.80, 0.38},
                                                       {0.50, 0.46, 0.72},
                                                       {0.55, 0.57, 0.60}}};
    return colours[static_cast<std::size_t>(index) % colours.size()];
}

Colour field_colour(double t) {
    t = std::clamp(std::isnan(t) ? 0.0 : t, 0.0, 1.0);
    const double lightness_of_t = 0.27 + 0.65 * t;
    const double hue = (305 - 203 * t) * std::numbers::pi / 180;
    const double chroma = 0.097 + 0.19 * (t - 0.45) * (t - 0.45);  // just inside the sRGB gamut everywhere
    return to_srgb(oklab_to_linear(lightness_of_t, chroma * std::cos(hue), chroma * std::sin(hue)));
}

double lightness(const Colour& srgb) {
    const Colour c = to_linear(srgb);
    const double l = std::cbrt(0.4122214708 * c.r + 0.5363325363 * c.g + 0.0514459929 * c.b);
    const double m = std::cbrt(0.2119034982 * c.r + 0.6806995451 * c.g + 0.1073969566 * c.b);
    const double s = std::cbrt(0.0883024619 * c.r + 0.2817188376 * c.g + 0.6299787005 * c.b);
    return 0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s;
}

}  // namespace pliant::report
