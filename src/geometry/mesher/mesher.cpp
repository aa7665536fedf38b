#include "geometry/mesher/mesher.hpp"

#include <algorithm>
#include <cstdint>

#include "geometry/mesher/mesh_worker.hpp"
#include "geometry/mesher/notches.hpp"
#include "geometry/mesher/packing.hpp"
#include "geometry/shapes/rod_surface.hpp"
#include "geometry/shapes/shape_names.hpp"

namespace pliant::mesh {
namespace {

constexpr const char* crash =
    "the mesher crashed inside Gmsh, Open CASCADE or CGAL; another mesh size or a simpler drawing may pass";

/// The error where round shapes crash it.
std::string crash_on(const std::string& what) {
    return fmt::format("the mesher crashed inside Gmsh, Open CASCADE or CGAL on {}; {}, or take another mesh size",
                       what, advice_on_contact);
}

std::string crash_on(std::span<const BodyGeometry> bodies) {
    std::string round;
    for (const BodyGeometry& body : bodies) {
        const auto* solid = std::get_if<Solid>(&body.shape);
        if (solid == nullptr || !has_round_shapes(*solid)) continue;
        round += fmt::format("{}body \"{}\" ({})", round.empty() ? "" : ", ", body.name, shapes_of({solid, 1}));
    }
    return round.empty() ? crash : crash_on(round);
}

std::string crash_on(const Solid& solid) {
    return has_round_shapes(solid) ? crash_on(shapes_of({&solid, 1})) : crash;
}

/// Asks again where the mesher crashes on round shapes: with their seams elsewhere it may not.
Result<std::string> ask_again(MessageKind kind, const std::string& request, const std::string& crashed,
                              Progress& progress) {
    for (std::uint8_t way = 0;; ++way) {
        Packer whole;
        whole.number(way);
        Result<std::string> answer = ask_mesher(kind, request + whole.take(), crashed, progress);
        if (answer || crashed == crash || way + 1 == seam_ways || !answer.error().message.starts_with(crashed))
            return answer;
    }
}

/// Open CASCADE has tolerances that are lengths: much smaller or larger shapes crash it or Gmsh.
Status check_extent(std::span<const BodyGeometry> bodies) {
    constexpr double smallest = 1e-5, largest = 2e5;
    const bool drawn = std::ranges::any_of(bodies, [](const BodyGeometry& body) {
        return std::holds_alternative<Solid>(body.shape) && !bounds(body).empty();
    });
    const double extent = bounds(bodies).diagonal();
    if (!drawn || (extent >= smallest && extent <= largest)) return {};
    return input_error(
        "the bodies measure {:.3g} length units from corner to corner, {:g} to {:g} can be meshed: choose another "
        "length_unit",
        extent, smallest, largest);
}

/// Coordinates are read to some 16 digits, and the mesher compares them to some 8.
Status check_near(std::span<const BodyGeometry> bodies) {
    constexpr double farthest_sizes = 1e6;
    for (const BodyGeometry& body : bodies) {
        const Box3 box = bounds(body);
        if (box.empty()) continue;
        const double far = norm(box.center()), size = box.diagonal();
        if (far > farthest_sizes * size)
            return input_error(
                "body \"{}\" measures {:.3g} and lies {:.3g} from the origin, more than {:g} times as far: its shape "
                "has no digits left; move it nearer",
                body.name, size, far, farthest_sizes);
    }
    return {};
}

}  // namespace

Box3 bounds(const BodyGeometry& body) {
    const auto* solid = std::get_if<Solid>(&body.shape);
    return solid != nullptr ? bounds(*solid) : bounds(std::get<TriMesh>(body.shape));
}

Box3 bounds(std::span<const BodyGeometry> bodies) {
    Box3 box;
    for (const BodyGeometry& body : bodies) {
        const Box3 own = bounds(body);
        if (own.empty()) continue;
        box.add(own.low);
        box.add(own.high);
    }
    return box;
}

double longest_side(std::span<const BodyGeometry> bodies) {
    const Vec3 size = bounds(bodies).size();
    return std::max({size.x, size.y, size.z});
}

Result<TetMesh> mesh_bodies(std::span<const BodyGeometry> bodies, const MeshSettings& settings, Progress& progress) {
    if (Status status = check_extent(bodies); !status) return tl::unexpected(status.error());
    if (Status status = check_near(bodies); !status) return tl::unexpected(status.error());
    Packer request;
    pack(request, bodies);
    pack(request, settings);
    return unpacked<TetMesh>(ask_again(MessageKind::mesh_bodies, request.take(), crash_on(bodies), progress));
}

Result<TriMesh> tessellate(const Solid& solid, double tolerance, Progress& progress) {
    if (!(tolerance > 0)) return input_error("the tolerance of a surface must be above zero");
    if (std::optional<TriMesh> rod = rod_surface(solid, tolerance)) return std::move(*rod);
    Packer request;
    pack(request, solid);
    request.number(tolerance);
    return unpacked<TriMesh>(ask_again(MessageKind::tessellate, request.take(), crash_on(solid), progress));
}

Result<TriMesh> tessellate(const Solid& solid, double tolerance) {
    Progress silent;
    return tessellate(solid, tolerance, silent);
}

Result<double> solid_volume(const Solid& solid) {
    Packer request;
    pack(request, solid);
    Progress silent;
    return unpacked<double>(ask_again(MessageKind::volume, request.take(), crash_on(solid), silent));
}

Result<std::vector<Notch>> crossed_notches(const TriMesh& surface, const std::vector<Vec3>& path) {
    Packer request;
    pack(request, surface);
    request.list(path);
    Progress silent;
    return unpacked<std::vector<Notch>>(ask_mesher(MessageKind::notches, request.take(), crash, silent));
}

}  // namespace pliant::mesh
