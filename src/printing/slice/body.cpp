#include "printing/slice/body.hpp"

#include <cmath>

namespace pliant::slice {

Status check(const Raster& raster) {
    constexpr int max_side_px = 65535;  // limit of the cells of a coverage map
    if (raster.width_px < 1 || raster.height_px < 1 || raster.width_px > max_side_px || raster.height_px > max_side_px)
        return input_error("raster of {} x {} pixels: each side must be 1 to {}", raster.width_px, raster.height_px,
                           max_side_px);
    if (static_cast<long long>(raster.width_px) * raster.height_px > (1LL << 28))
        return input_error("raster of {} x {} pixels: more than 2^28 in all", raster.width_px, raster.height_px);
    if (!(raster.pixel_um > 0 && raster.pixel_um <= 10000))
        return input_error("pixel of {:.6g} um: must be above 0 and at most 10000 um", raster.pixel_um);
    if (!(std::fabs(raster.rotation_deg) <= 360))
        return input_error("image turned by {} degrees: must be -360 to 360", raster.rotation_deg);
    if (!(std::fabs(raster.offset_x_um) <= raster.width_um() && std::fabs(raster.offset_y_um) <= raster.height_um()))
        return input_error("image moved by {:.6g} and {:.6g} um: must be at most its size, {:.6g} x {:.6g} um",
                           raster.offset_x_um, raster.offset_y_um, raster.width_um(), raster.height_um());
    return {};
}

void move(Body& body, const Vec3& shift_um) {
    each_point(body, [&](Vec3& p) { p += shift_um; });
    if (body.blend) {
        body.blend->from_um += shift_um;
        body.blend->to_um += shift_um;
    }
    for (OutlineSlice& slice : body.slices) {
        slice.bottom_um += shift_um.z;
        slice.top_um += shift_um.z;
        for (auto& outline : slice.outlines_um) {
            for (auto& [x, y] : outline) {
                x += shift_um.x;
                y += shift_um.y;
            }
        }
    }
}

Result<Box3> bounds(const Body& body, const std::string& label) {
    Box3 box;
    for (const OutlineSlice& slice : body.slices) {
        for (const auto& outline : slice.outlines_um) {
            for (const auto& [x, y] : outline) {
                for (const double z : {slice.bottom_um, slice.top_um}) {
                    const Vec3 p{x, y, z};
                    if (!is_finite(p)) return input_error("{}: a point of its outlines is not finite", label);
                    box.add(p);
                }
            }
        }
    }
    if (!body.slices.empty()) return box;
    const mesh::TriMesh& surface = body.surface_um;
    const int count = static_cast<int>(surface.points.size());
    for (const auto& triangle : surface.triangles) {
        for (const int corner : triangle) {
            if (corner < 0 || corner >= count)
                return input_error("{}: a triangle names point {}, there are {}", label, corner, count);
            if (!is_finite(surface.points[corner])) return input_error("{}: point {} is not finite", label, corner);
            box.add(surface.points[corner]);
        }
    }
    return box;
}

std::string describe(const Body& body, std::size_t index) {
    if (!body.name.empty()) return fmt::format("body '{}' ({})", body.name, body.material);
    return fmt::format("body {} ({})", index + 1, body.material);
}

}  // namespace pliant::slice
