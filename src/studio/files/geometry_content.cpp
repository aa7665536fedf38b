#include "studio/files/geometry_content.hpp"

#include <algorithm>

#include "base/core/boxes.hpp"
#include "base/core/counted.hpp"
#include "geometry/mesher/step_file.hpp"
#include "geometry/open/open_geometry.hpp"

namespace pliant::studio {
namespace {

Box3 box_of(const std::vector<Vec3>& points) {
    const Box3 box = bounds_of(points);
    return box;
}

Result<GeometryContent> content_of(const mesh::TetMesh& mesh) {
    std::string text = fmt::format("tet mesh, {}", counted(mesh.tet_count(), "tet"));
    return GeometryContent{"tets", 0, box_of(mesh.points), std::move(text), mesh.region_names, mesh.notes};
}

Result<GeometryContent> content_of(const mesh::SurfaceFile& surface) {
    if (surface.mesh.triangles.empty()) return input_error("the surface has no triangles");
    std::string text = fmt::format("surface, {}", counted(surface.mesh.triangles.size(), "triangle"));
    return GeometryContent{"surface", 0, box_of(surface.mesh.points), std::move(text), {}, surface.warnings};
}

Result<GeometryContent> content_of(const threemf::ThreeMf& plate) {
    if (plate.bodies.empty()) return input_error("the 3MF file has no body");
    GeometryContent content{"3mf",         1, {}, "3MF file, " + counted(plate.bodies.size(), "body", "bodies"), {},
                            plate.warnings};
    for (const threemf::Body& body : plate.bodies) {
        if (!body.slices.empty())
            return input_error("{}: is a stack of slices, which can be printed but not simulated; surfaces are needed",
                               body.name);
        for (const Vec3& p : body.mesh_mm.points) content.box.add(p);
        if (std::ranges::find(content.parts, body.material) == content.parts.end())
            content.parts.push_back(body.material);
    }
    if (content.parts.size() == 1) content.parts.clear();
    return content;
}

Result<GeometryContent> content_of(const mesh::StepPath& step) {
    const Result<mesh::Solid> solids = mesh::read_step(step.path, "", 1);
    if (!solids) return tl::unexpected(solids.error());
    const std::size_t count = std::get<mesh::StepSolid>((*solids)->shape).numbers.size();
    return GeometryContent{"step", 1, mesh::bounds(*solids), fmt::format("STEP file, {}", counted(count, "solid"))};
}

}  // namespace

Result<GeometryContent> geometry_content(const std::filesystem::path& path) {
    const Result<mesh::Geometry> geometry = mesh::open_geometry(path);
    if (!geometry) return tl::unexpected(geometry.error());
    return std::visit([](const auto& one) { return content_of(one); }, *geometry);
}

}  // namespace pliant::studio
