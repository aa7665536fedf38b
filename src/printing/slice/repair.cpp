#include "printing/slice/repair.hpp"

#include <algorithm>
#include <cmath>

#include "base/core/counted.hpp"
#include "printing/slice/holes.hpp"
#include "printing/slice/layer_text.hpp"
#include "printing/slice/shells.hpp"

namespace pliant::slice {
namespace {

int layer_at(std::int32_t z, const Layers& layers) {
    // The first layer with its top above z.
    const int k = layers.middles_up_to(z, grid_per_um);
    return k > 0 && std::int64_t{layers.top_um(k - 1)} * grid_per_um > z ? k - 1 : k;
}

/// The uppermost layer of the surface: a layer is printed where its middle is inside.
int last_layer(const GridSurface& surface, const Layers& layers) {
    std::int32_t top = surface.points.front().z;
    for (const GridPoint& point : surface.points) top = std::max(top, point.z);
    return std::max(0, layers.middles_up_to(top, grid_per_um) - 1);
}

/// A hole reaches into the layers below its highest point, not into the one that begins there.
std::string hole_warning(const Holes& holes, const std::string& label, int last, const Layers& layers) {
    const int low = std::min(last, layer_at(holes.z_low, layers));
    const int high = std::min(last, layer_at(std::max(holes.z_low, holes.z_high - 1), layers));
    return fmt::format("{}: {} hole{} ({} open edges, {:.3g} mm^2) closed in {}", label, holes.count,
                       holes.count == 1 ? "" : "s", holes.edges, holes.area_mm2, layers_text(low, high));
}

std::string join_warning(std::size_t points, const std::string& label, double join_um) {
    return fmt::format("{}: joined {} at open edges to another one within {:.3g} um", label, counted(points, "point"),
                       join_um);
}

/// Orients triangles and closes holes.
Status close_surface(GridSurface& surface, const std::string& label, const Layers& layers,
                     std::vector<std::string>& warnings) {
    const double area = area_mm2(surface);
    if (const int turned = orient_consistently(surface); turned > 0)
        warnings.push_back(fmt::format("{}: flipped {} that ran against the neighbours", label,
                                       counted(static_cast<std::size_t>(turned), "triangle")));
    const Holes holes = close_holes(surface);
    if (holes.area_mm2 > 0.25 * area)
        return input_error(
            "{}: the surface is open: {:.4g} mm^2 are missing beside {:.4g} mm^2; a closed surface is needed", label,
            holes.area_mm2, area);
    if (holes.count > 0) warnings.push_back(hole_warning(holes, label, last_layer(surface, layers), layers));
    return {};
}

}  // namespace

Result<Repaired> repair(const mesh::TriMesh& surface_um, const std::string& label, const Layers& layers,
                        double join_um) {
    auto snapped = snap_to_grid(surface_um, label);
    if (!snapped) return tl::unexpected(snapped.error());
    Repaired result{std::move(*snapped), {}};
    GridSurface& surface = result.surface;
    if (surface.triangles.empty()) return input_error("{}: the surface has no triangle with an area", label);
    const double area = area_mm2(surface);
    std::vector<EdgeUse> uses = edge_uses(surface.triangles);
    if (!all_paired(uses)) {
        if (const std::size_t points = join_near_points(surface, join_um); points > 0)
            result.warnings.push_back(join_warning(points, label, join_um));
        if (auto status = close_surface(surface, label, layers, result.warnings); !status)
            return tl::unexpected(status.error());
        uses = edge_uses(surface.triangles);
    }
    if (const int turned = turn_inverted_shells(surface, uses); turned > 0)
        result.warnings.push_back(fmt::format("{}: flipped {} that {} inside out", label,
                                              counted(static_cast<std::size_t>(turned), "shell"),
                                              turned == 1 ? "was" : "were"));
    // A solid thinner than a grid unit everywhere is a sheet drawn twice.
    if (volume_mm3(surface) < 0.5e-3 / grid_per_um * area)
        return input_error("{}: the surface encloses no volume; a closed surface is needed", label);
    return result;
}

}  // namespace pliant::slice
