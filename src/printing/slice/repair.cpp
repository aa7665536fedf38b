#include "printing/slice/repair.hpp"

#include <cmath>

#include "base/core/counted.hpp"
#include "printing/slice/holes.hpp"
#include "printing/slice/shells.hpp"

namespace pliant::slice {
namespace {

int layer_at(std::int32_t z, const Layers& layers) {
    // The first layer with its top above z.
    const int k = layers.middles_up_to(z, grid_per_um);
    return k > 0 && std::int64_t{layers.top_um(k - 1)} * grid_per_um > z ? k - 1 : k;
}

std::string hole_warning(const Holes& holes, const std::string& label, const Layers& layers) {
    return fmt::format("{}: {} hole{} ({} open edges, {:.3g} mm^2) closed in layers {} to {}", label, holes.count,
                       holes.count == 1 ? "" : "s", holes.edges, holes.area_mm2, layer_at(holes.z_low, layers),
                       layer_at(holes.z_high, layers));
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
    if (holes.count > 0) warnings.push_back(hole_warning(holes, label, layers));
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
