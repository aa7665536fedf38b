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

double row_um(int count, double size, double spacing) {
    return count * size + (count - 1) * spacing;
}

/// Columns and rows of copies.
struct Grid {
    int columns = 0, rows = 0;
    [[nodiscard]] long long places() const { return static_cast<long long>(columns) * rows; }
};

/// The most columns that fit in so many rows; unlimited for a part without extent.
int fitting(const Room& room, const Vec3& size, double spacing, int rows) {
    int low = 0, high = most_copies;
    while (low < high) {
        const int columns = (low + high + 1) / 2;
        if (room.holds(row_um(columns, size.x, spacing), row_um(rows, size.y, spacing)))
            low = columns;
        else
            high = columns - 1;
    }
    return low;
}

/// The grid of the fewest rows with that many places; the one with the most if there are not so many.
Grid grid_of(const Room& room, const Vec3& size, double spacing, int count) {
    Grid most;
    for (int rows = 1; rows <= most_copies && most.places() < count; ++rows) {
        const Grid grid{fitting(room, size, spacing, rows), rows};
        if (grid.columns == 0) break;
        if (grid.places() > most.places()) most = grid;
    }
    return most;
}

}  // namespace

Room::Room(const Raster& raster)
    : width_um_(0),
      depth_um_(0),
      column_um_(std::max(0.0, raster.width_um() - 2 * std::fabs(raster.offset_x_um))),
      row_um_(std::max(0.0, raster.height_um() - 2 * std::fabs(raster.offset_y_um))),
      cosine_(turn_of(raster)[0]),
      sine_(turn_of(raster)[1]),
      off_centre_(raster.offset_x_um != 0 || raster.offset_y_um != 0) {
    width_um_ = cosine_ * column_um_ + sine_ * row_um_;
    depth_um_ = sine_ * column_um_ + cosine_ * row_um_;
}

void Room::limit(double width_um, double depth_um) {
    on_platform_ = width_um < width_um_ || depth_um < depth_um_;
    width_um_ = std::min(width_um_, width_um);
    depth_um_ = std::min(depth_um_, depth_um);
}

std::string Room::name() const {
    if (!off_centre_) return on_platform_ ? "the platform" : "an image";
    return on_platform_ ? "the platform under an image that is not in its middle"
                        : "an image around the middle of the platform";
}

bool Room::holds(double x_um, double y_um) const {
    constexpr double rounding_um = 1;
    return x_um <= width_um_ + rounding_um && y_um <= depth_um_ + rounding_um &&
           cosine_ * x_um + sine_ * y_um <= column_um_ + rounding_um &&
           sine_ * x_um + cosine_ * y_um <= row_um_ + rounding_um;
}

Status scale(std::vector<Body>& bodies, double factor) {
    constexpr double least = 0.001, most = 1000;  // between metres and millimetres
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
    const Grid grid = grid_of(room, size, spacing_um, count);
    if (grid.places() < count)
        return input_error(
            "{} copies of {:.3f} x {:.3f} mm, {:.3f} mm apart, do not fit {} of {:.3f} x {:.3f} mm: {} do", count,
            size.x / 1000, size.y / 1000, spacing_um / 1000, room.name(), room.width_um() / 1000,
            room.depth_um() / 1000, grid.places());
    const int columns = std::min(count, grid.columns);
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
