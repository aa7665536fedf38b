#include "robot/bodies/crossed_notches.hpp"

#include <algorithm>
#include <memory>

#include "geometry/mesher/mesher.hpp"
#include "geometry/mesher/notches.hpp"

namespace pliant::robot {
namespace {

/// Tolerance of the surface used to find notches, as a share of the robot's size: about 48 chords per turn.
constexpr double surface_share = 2e-3;

mesh::Solid solid(decltype(mesh::SolidNode::shape) shape) {
    return std::make_shared<const mesh::SolidNode>(mesh::SolidNode{std::move(shape)});
}

bool is_known(const mesh::Notch& notch, const mesh::NotchesSolid& known, const std::vector<mesh::Solid>& air) {
    const auto holds = [&](const mesh::Solid& s) { return mesh::contains(s, notch.point); };
    return std::any_of(known.hulls.begin(), known.hulls.end(), holds) || std::any_of(air.begin(), air.end(), holds);
}

}  // namespace

Result<mesh::Solid> crossed_notches(const Robot& robot, const std::vector<mesh::Solid>& bodies,
                                    const std::vector<mesh::Solid>& air) {
    const mesh::Solid whole = solid(mesh::CombinedSolid{mesh::CombinedSolid::Operation::unite, bodies});
    const double tolerance = surface_share * mesh::bounds(whole).diagonal();
    const Result<mesh::TriMesh> surface = mesh::tessellate(whole, tolerance);
    if (!surface) return tl::unexpected(surface.error());
    mesh::NotchesSolid found{{}, {}, bodies};
    for (const CableSpec& cable : robot.cables) {
        if (!cable.fill_notches) continue;
        const Result<std::vector<mesh::Notch>> notches = mesh::crossed_notches(*surface, cable.points);
        if (!notches) return tl::unexpected(notches.error());
        if (notches->empty())
            return input_error_at(
                robot.file.string(), cable.line,
                "cable \"{}\": fill_notches finds none: nowhere does the cable leave a body and enter one again",
                cable.name);
        for (const mesh::Notch& notch : *notches) {
            if (is_known(notch, found, air)) continue;
            found.hulls.push_back(notch.hull);
            found.points.push_back(notch.point);
        }
    }
    if (found.hulls.empty())
        return input_error(
            "{}: fill_notches: every notch that a cable crosses is drawn as a [[gap]] or a chamber already",
            robot.file.string());
    return solid(std::move(found));
}

}  // namespace pliant::robot
