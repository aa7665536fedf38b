#include "printing/slice/arrange.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "printing/slice/place.hpp"

namespace pliant::slice {
namespace {

/// Rotates (a, b) counter-clockwise.
void turn_pair(double& a, double& b, double degrees) {
    const double turned = std::remainder(degrees, 360.0);
    double c = std::cos(turned * std::numbers::pi / 180), s = std::sin(turned * std::numbers::pi / 180);
    if (std::remainder(turned, 90.0) == 0) {
        c = std::round(c);
        s = std::round(s);
    }
    const double x = a;
    a = c * x - s * b;
    b = s * x + c * b;
}

constexpr int most_copies = 10000;

/// Number of copies that fit in a row; unlimited for a part without extent.
int fitting(double room, double size, double spacing) {
    return static_cast<int>(std::clamp(std::floor((room + spacing + 1) / (size + spacing)), 0.0, 1.0 * most_copies));
}

}  // namespace

Status scale(std::vector<Body>& bodies, double factor) {
    constexpr double least = 0.01, most = 100;
    if (!(factor >= least && factor <= most))
        return input_error("a scale of {:.6g}: must be {} to {}", factor, least, most);
    for (Body& body : bodies) {
        each_point(body, [&](Vec3& p) { p *= factor; });
        body.chord_um *= factor;
        if (body.blend) {
            body.blend->from_um *= factor;
            body.blend->to_um *= factor;
        }
        for (OutlineSlice& slice : body.slices) {
            slice.bottom_um *= factor;
            slice.top_um *= factor;
            for (auto& outline : slice.outlines_um) {
                for (auto& [x, y] : outline) {
                    x *= factor;
                    y *= factor;
                }
            }
        }
    }
    return {};
}

Status turn(std::vector<Body>& bodies, const Vec3& degrees) {
    if (!is_finite(degrees))
        return input_error("rotation by {}, {}, {} degrees: must be finite", degrees.x, degrees.y, degrees.z);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        if (!bodies[i].slices.empty() && (degrees.x != 0 || degrees.y != 0))
            return input_error("{}: consists of slices, which can be turned about z only", describe(bodies[i], i));
        const auto turn_point = [&](Vec3& p) {
            turn_pair(p.y, p.z, degrees.x);
            turn_pair(p.z, p.x, degrees.y);
            turn_pair(p.x, p.y, degrees.z);
        };
        each_point(bodies[i], turn_point);
        if (bodies[i].blend) {
            turn_point(bodies[i].blend->from_um);
            turn_point(bodies[i].blend->to_um);
        }
        for (OutlineSlice& slice : bodies[i].slices) {
            for (auto& outline : slice.outlines_um) {
                for (auto& [x, y] : outline) turn_pair(x, y, degrees.z);
            }
        }
    }
    return {};
}

Status repeat(std::vector<Body>& bodies, int count, double spacing_um, const Room& room) {
    if (count < 1 || count > most_copies) return input_error("{} copies: must be 1 to {}", count, most_copies);
    if (!(spacing_um >= 0 && std::isfinite(spacing_um)))
        return input_error("copies {:.6g} um apart: must be 0 or more", spacing_um);
    if (count == 1) return {};
    const auto box = bounds_of_all(bodies);
    if (!box) return tl::unexpected(box.error());
    if (box->empty()) return {};
    const Vec3 size = box->size();
    const int columns = std::min(count, fitting(room.width_um, size.x, spacing_um));
    const int rows = fitting(room.depth_um, size.y, spacing_um);
    if (static_cast<long long>(columns) * rows < count)
        return input_error(
            "{} copies of {:.3f} x {:.3f} mm, {:.3f} mm apart, do not fit {} of {:.3f} x {:.3f} mm: {} do", count,
            size.x / 1000, size.y / 1000, spacing_um / 1000, room.name, room.width_um / 1000, room.depth_um / 1000,
            static_cast<long long>(fitting(room.width_um, size.x, spacing_um)) * rows);
    const std::vector<Body> part = bodies;
    for (int n = 1; n < count; ++n) {
        const int column = n % columns, row = n / columns;
        const Vec3 shift{column * (size.x + spacing_um), row * (size.y + spacing_um), 0};
        for (std::size_t i = 0; i < part.size(); ++i) {
            bodies.push_back(part[i]);
            if (!part[i].name.empty()) bodies.back().name += fmt::format(" #{}", n + 1);
            move(bodies.back(), shift);
        }
    }
    return {};
}

}  // namespace pliant::slice
