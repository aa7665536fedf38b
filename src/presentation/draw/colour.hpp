// Colours: sRGB for display and files, linear light for shading, and one perceptual map for fields.
#pragma once

#include <string>

namespace pliant::report {

/// Red, green, blue in [0, 1]; the comment or name at each use says whether sRGB or linear light.
struct Colour {
    double r = 0, g = 0, b = 0;
    bool operator==(const Colour&) const = default;
};

inline Colour operator*(double s, const Colour& c) {
    return {s * c.r, s * c.g, s * c.b};
}
inline Colour operator*(const Colour& a, const Colour& b) {
    return {a.r * b.r, a.g * b.g, a.b * b.b};
}
inline Colour operator+(const Colour& a, const Colour& b) {
    return {a.r + b.r, a.g + b.g, a.b + b.b};
}
inline Colour& operator+=(Colour& a, const Colour& b) {
    return a = a + b;
}
/// (1 - t) a + t b
inline Colour mix(const Colour& a, const Colour& b, double t) {
    return (1 - t) * a + t * b;
}

/// The transfer function of IEC 61966-2-1, one way and the other; inputs outside [0, 1] are clamped.
[[nodiscard]] Colour to_linear(const Colour& srgb);
[[nodiscard]] Colour to_srgb(const Colour& linear);

/// "#rrggbb" of an sRGB colour.
[[nodiscard]] std::string hex(const Colour& srgb);
/// The sRGB colour of "#rrggbb". Precondition: the text has this form.
[[nodiscard]] Colour colour_of_hex(const std::string& text);

/// sRGB colours that are distinguishable with the common colour vision deficiencies; they repeat after eight.
[[nodiscard]] Colour palette(int index);

/// sRGB colour of a field value t in [0, 1], dark violet over teal to yellow. Lightness rises linearly in the OKLab
/// space (B. Ottosson, "A perceptual color space for image processing", 2020), so that equal steps look equal and the
/// map survives a grey print.
[[nodiscard]] Colour field_colour(double t);

/// Colour of cables, sRGB: stands out from every colour of the palette.
inline constexpr Colour cable_colour = {0.80, 0.10, 0.14};
inline constexpr Colour obstacle_colour = {0.70, 0.72, 0.75};
inline constexpr Colour element_colour = {0.10, 0.55, 0.38};  ///< of meshed space that drives an actuator
inline constexpr Colour element_edge_colour = {0.03, 0.24, 0.16};
inline constexpr Colour measured_colour = {0.80, 0.12, 0.40};  ///< of measured markers

/// OKLab lightness of an sRGB colour, 0 black to 1 white.
[[nodiscard]] double lightness(const Colour& srgb);

}  // namespace pliant::report
