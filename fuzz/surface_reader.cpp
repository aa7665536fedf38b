// One target per reader of surfaces: PLIANT_PARSER is parse_stl, parse_obj, parse_ply or parse_off.
#include "geometry/files/surface_file.hpp"
#include "geometry/files/surface_mending.hpp"
#include "geometry/repair/surface_check.hpp"
#include "geometry/repair/surface_slivers.hpp"
#include "input.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    auto surface = pliant::mesh::PLIANT_PARSER(as_text(data, size), "fuzz.surface");
    if (!surface) return 0;
    pliant::mesh::mend_surface(*surface, "fuzz.surface");
    for (const auto& triangle : surface->mesh.triangles) {
        for (const int corner : triangle) (void)surface->mesh.points.at(static_cast<std::size_t>(corner));
    }
    (void)pliant::mesh::check_closed(surface->mesh);
    (void)pliant::mesh::remove_slivers(surface->mesh);
    return 0;
}
