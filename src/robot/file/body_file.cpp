#include "robot/file/body_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "base/core/text.hpp"
#include "geometry/mesher/step_file.hpp"
#include "geometry/open/open_geometry.hpp"
#include "robot/file/material_file.hpp"
#include "robot/file/material_library.hpp"

namespace pliant::robot {
namespace {

using config::Reader;

MaterialSpec read_one_material(Reader& reader, const std::string& name) {
    MaterialSpec material = read_material(reader, name);
    reader.finish();
    return material;
}

/// A density a thousand times too large is easily written, as in "1040 g/cm^3".
void note_densities(Robot& robot) {
    constexpr double densest_kg_m3 = 23e3;  // osmium
    for (const MaterialSpec& material : robot.materials) {
        if (material.density_kg_m3 > densest_kg_m3)
            robot.notes.push_back(fmt::format("material \"{}\" has {:.6g} kg/m^3, more than any substance on earth",
                                              material.name, material.density_kg_m3));
    }
}

void read_materials(Reader& root, Context& context) {
    const config::Value* tables = root.raw("material");
    for (auto& [name, reader] : root.named_tables("material")) {
        if (!reader.has("base")) {
            context.robot.materials.push_back(read_one_material(reader, name));
            (void)reader.raw("base");
            continue;
        }
        const std::string base = reader.text("base");
        if (const Result<LibraryMaterial> found = library_material(base); !found) {
            reader.problem("base", found.error().message);
            context.robot.materials.emplace_back().name = name;
            continue;
        }
        for (const auto& [key, own] : std::get<config::Table>(tables->data)) {
            if (key != name) continue;
            const config::Value merged = with_base(own, base);
            Reader whole(merged, context.problems, reader.path());
            context.robot.materials.push_back(read_one_material(whole, name));
        }
    }
    note_densities(context.robot);
}

/// A length above zero, in length units; 0 where the key is missing.
double read_size(Reader& reader, std::string_view key, const Context& context) {
    if (!reader.has(key)) {
        (void)reader.raw(key);
        return 0;
    }
    const double size = reader.quantity(key, Dimension::length, 1) / context.robot.unit_m;
    if (!(size > 0)) reader.problem(key, "must be above zero");
    if (context.robot.mesh.file) reader.problem(key, "has no meaning together with a mesh file");
    return size;
}

/// The largest width of gaps between bodies that are closed.
void read_close_gaps(Reader& reader, Context& context) {
    if (!reader.has("close_gaps")) {
        (void)reader.raw("close_gaps");
        return;
    }
    const double width = reader.quantity("close_gaps", Dimension::length, 0) / context.robot.unit_m;
    if (!(width >= 0)) reader.problem("close_gaps", "must not be below zero; \"0 mm\" closes none");
    if (context.robot.mesh.file) reader.problem("close_gaps", "has no meaning together with a mesh file");
    context.robot.mesh.close_gaps = width;
}

/// How far outside the mesh a guide point or a marker may lie.
void read_point_reach(Reader& reader, Context& context) {
    if (!reader.has("point_reach")) {
        (void)reader.raw("point_reach");
        return;
    }
    const double reach = reader.quantity("point_reach", Dimension::length, 0) / context.robot.unit_m;
    if (!(reach >= 0))
        reader.problem("point_reach", "must not be below zero; \"0 mm\" still allows a thousandth of the robot's size");
    context.robot.mesh.point_reach = reach;
}

void read_mesh(Reader& root, Context& context) {
    Reader reader = root.table("mesh", false);
    MeshSpec& mesh = context.robot.mesh;
    mesh.line = reader.line();
    mesh.order = reader.whole("order", 1, 2, 2);  // linear tets, quadratic tets
    if (reader.has("file")) {
        const std::string file = reader.text("file");
        mesh.file = file == mesh_in_memory ? std::filesystem::path(file) : need_file(reader, "file", file, context);
        mesh.placement = read_placement(reader, "place");
    }
    mesh.size = read_size(reader, "size", context);
    mesh.size_near_cables = read_size(reader, "size_near_cables", context);
    read_close_gaps(reader, context);
    read_point_reach(reader, context);
    if (reader.has("elements_through_wall")) {
        mesh.elements_through_wall = reader.whole("elements_through_wall", 0, 20, 3);
        if (mesh.file) reader.problem("elements_through_wall", "has no meaning together with a mesh file");
    }
    (void)reader.raw("elements_through_wall");
    reader.finish();
}

/// A material of the robot file or, failing that, of the library.
int find_material(Reader& reader, Context& context) {
    const std::string wanted = reader.text("material");
    std::vector<MaterialSpec>& materials = context.robot.materials;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < materials.size(); ++i) {
        names.push_back(materials[i].name);
        if (names.back() == wanted) return static_cast<int>(i);
    }
    if (wanted.empty()) {  // a missing or invalid value has already been reported
        const config::Value* given = reader.raw("material");
        if (given != nullptr && std::holds_alternative<std::string>(given->data))
            reader.problem("material", "is empty; name a material of this file or of the library");
        return 0;
    }
    if (Result<LibraryMaterial> found = library_material(wanted)) {
        materials.push_back(std::move(found->spec));
        materials.back().from_library = true;
        return static_cast<int>(materials.size()) - 1;
    }
    const std::string near = nearest_name(wanted, names);
    if (!near.empty())
        reader.problem("material", fmt::format("no material \"{}\"; did you mean \"{}\"?", wanted, near));
    else if (names.empty())
        reader.problem("material", fmt::format("no material \"{}\" in the library{}", wanted, library_hint(wanted)));
    else
        reader.problem("material", fmt::format("no material \"{}\"; there is {}, and the library{}", wanted,
                                               join_names(names), library_hint(wanted)));
    return 0;
}

/// A solid keeps its curved faces, so it cannot be scaled or mirrored.
mesh::Solid placed_solid(Reader& reader, mesh::Solid solid, const mesh::Placement& placement) {
    if (placement.scale != 1 || norm(placement.mirror_normal) > 0)
        reader.problem("place", "a STEP file can be rotated, moved and repeated, not scaled or mirrored");
    const auto make = [](auto shape) { return std::make_shared<const mesh::SolidNode>(mesh::SolidNode{shape}); };
    const auto move = [&](const mesh::Solid& of, const mesh::RigidMotion& motion) -> mesh::Solid {
        return make(mesh::TranslatedSolid{make(mesh::RotatedSolid{of, motion.center, motion.axis, motion.angle_rad}),
                                          motion.shift});
    };
    if (reader.has("place")) solid = move(solid, placement.motion);
    mesh::CombinedSolid all{mesh::CombinedSolid::Operation::unite, {solid}};
    while (static_cast<int>(all.parts.size()) < placement.count)
        all.parts.push_back(move(all.parts.back(), placement.step));
    return all.parts.size() == 1 ? solid : make(std::move(all));
}

/// A STEP file becomes a solid like drawn ones; other files are triangles, which are read when needed.
Geometry read_file_body(Reader& reader, const std::string& file, Context& context) {
    const std::filesystem::path path = need_file(reader, "geometry", file, context);
    const std::string part = reader.has("part") ? reader.text("part") : "";
    (void)reader.raw("part");
    if (reader.has("part") && part.empty())
        reader.problem("part", "is empty; name a part, or leave it out to take all");
    const mesh::Placement placement = read_placement(reader, "place");
    const mesh::GeometryKind kind = mesh::geometry_kind_of(path);
    if (kind != mesh::GeometryKind::step) {
        if (!part.empty() && kind != mesh::GeometryKind::threemf)
            reader.problem("part", "chooses from a STEP or 3MF file");
        return SurfaceFile{path, part, placement};
    }
    Result<mesh::Solid> solid = mesh::read_step(path, part, 1e-3 / context.robot.unit_m);
    if (solid) return placed_solid(reader, std::move(*solid), placement);
    reader.problem("geometry", solid.error().message);
    return SurfaceFile{path, part};
}

Geometry read_geometry(Reader& reader, Context& context) {
    const bool has_mesh_file = context.robot.mesh.file.has_value();
    if (reader.has("region")) {
        const std::string region = reader.text("region");
        if (reader.has("geometry"))
            reader.problem("region",
                           "stands beside geometry; region is for a body of a mesh file ([mesh] file = "
                           "\"...\"), geometry for any other");
        else if (!has_mesh_file)
            reader.problem("region", "needs a tet mesh; add file = \"...\" to [mesh]");
        (void)reader.raw("geometry");
        if (reader.has("place")) reader.problem("place", "is for a file of one body; that of a mesh file is in [mesh]");
        if (reader.has("box")) return MeshRegion{region, read_box(reader)};
        return MeshRegion{region, {}};
    }
    if (has_mesh_file) {
        reader.problem("", "with a mesh file a body names its region: region = \"...\" or region = \"all\"");
        (void)reader.raw("geometry");
        return MeshRegion{"all", {}};
    }
    const config::Value* geometry = reader.raw("geometry");
    if (geometry == nullptr) {
        reader.problem("",
                       "\"geometry\" is missing; it is a file such as \"finger.stl\" or a shape such as { box = "
                       "[[0,0,0],[1,1,1]] }");
        return MeshRegion{"all", {}};
    }
    if (const auto* file = std::get_if<std::string>(&geometry->data)) return read_file_body(reader, *file, context);
    if (reader.raw("part") != nullptr) reader.problem("part", "chooses from a STEP or 3MF file");
    if (reader.raw("place") != nullptr)
        reader.problem("place", "is for files; a shape is placed by translate, rotate and repeat");
    return read_shape(reader, context);
}

/// The gradient of a printed body towards another material.
std::optional<PrintBlend> read_blend(Reader& body, Context& context) {
    if (!body.has("blend")) return (void)body.raw("blend"), std::nullopt;
    Reader reader = body.table("blend");
    PrintBlend blend;
    blend.material = find_material(reader, context);
    blend.from = reader.vector("from");
    blend.to = reader.vector("to");
    if (reader.has("from") && reader.has("to") && norm(blend.to - blend.from) == 0)
        reader.problem("to", "is where \"from\" is; the blend needs a way to change on");
    if (reader.has("shares")) blend.shares = reader.numbers("shares");
    const bool shares =
        std::all_of(blend.shares.begin(), blend.shares.end(), [](double s) { return s >= 0 && s <= 1; });
    if (blend.shares.size() < 2 || !shares) reader.problem("shares", "are two numbers or more from 0 to 1");
    (void)reader.raw("shares");
    if (reader.has("cell")) {
        blend.cell = reader.quantity("cell", Dimension::length, 1) / context.robot.unit_m;
        if (!(blend.cell > 0)) reader.problem("cell", "must be above zero");
    }
    (void)reader.raw("cell");
    reader.finish();
    return blend;
}

void read_body(Reader& reader, Context& context, BodySpec& body) {
    body.material = find_material(reader, context);
    body.geometry = read_geometry(reader, context);
    body.size = read_size(reader, "size", context);
    body.blend = read_blend(reader, context);
    if (body.blend && body.blend->material == body.material && !reader.unreadable("blend"))
        context.robot.notes.push_back(
            fmt::format("body \"{}\" blends into its own material \"{}\", which changes "
                        "nothing",
                        body.name, reader.text("material")));
    body.exposure_s = read_exposure(reader, "exposure");
}

}  // namespace

void read_bodies(Reader& root, Context& context) {
    read_materials(root, context);
    read_mesh(root, context);
    read_each(root, context, "body", "bodies", context.robot.bodies, read_body);
    if (context.robot.bodies.empty() && !root.unreadable("body")) root.problem("", "there is no body; add [[body]]");
}

}  // namespace pliant::robot
