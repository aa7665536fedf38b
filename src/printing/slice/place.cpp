#include "printing/slice/place.hpp"

#include <cmath>

#include "printing/slice/raster_frame.hpp"

namespace pliant::slice {

Result<Box3> bounds_of_all(std::span<const Body> bodies) {
    Box3 box;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const auto own = bounds(bodies[i], describe(bodies[i], i));
        if (!own) return own;
        if (own->empty()) continue;
        box.add(own->low);
        box.add(own->high);
    }
    return box;
}

Result<std::vector<std::string>> place_on_platform(std::span<Body> bodies, const Raster& raster) {
    if (auto status = check(raster); !status) return tl::unexpected(status.error());
    const auto box = bounds_of_all(bodies);
    if (!box) return tl::unexpected(box.error());
    if (box->empty()) return input_error("there is no triangle to print");
    const Vec3 size = box->size();
    const ImageExtent image = image_extent(raster);
    if (size.x > image.x_um + 1 || size.y > image.y_um + 1)
        return input_error("the part measures {:.3f} x {:.3f} mm, the image only {:.3f} x {:.3f} mm", size.x / 1000,
                           size.y / 1000, image.x_um / 1000, image.y_um / 1000);
    std::vector<std::string> warnings;
    const double far_um = std::fmax(norm(box->low), norm(box->high));
    // Mesh files commonly have 24-bit mantissas: warn if that is coarser than a tenth of a pixel.
    const double spacing_um = std::exp2(std::floor(std::log2(far_um)) - 23);
    if (far_um > 0 && spacing_um > raster.pixel_um / 10)
        warnings.push_back(
            fmt::format("the part was drawn {:.4g} mm from the origin, where a 32-bit mesh file can only keep steps of "
                        "{:.3g} um; it was moved to the platform as it is",
                        far_um / 1000, spacing_um));
    const Vec3 shift{-box->center().x, -box->center().y, -box->low.z};
    for (Body& body : bodies) move(body, shift);
    return warnings;
}

}  // namespace pliant::slice
