#include "robot/bodies/build.hpp"

#include <algorithm>
#include <cmath>

#include "base/core/boxes.hpp"
#include "base/core/text.hpp"
#include "geometry/files/surface_file.hpp"
#include "geometry/files/tet_file.hpp"
#include "geometry/mesh/triangle_corners.hpp"
#include "geometry/mesher/mesher.hpp"
#include "geometry/repair/narrow_gaps.hpp"
#include "geometry/shapes/flat_faces.hpp"
#include "geometry/shapes/overlap_note.hpp"
#include "robot/bodies/body_surface.hpp"
#include "robot/bodies/crossed_notches.hpp"
#include "robot/bodies/mesh_budget.hpp"
#include "robot/description/regions.hpp"

namespace pliant::robot {
namespace {

/// Location of a thing in the robot file, for problem messages.
Diagnostic place(const Robot& robot, int line, std::string_view kind, std::string_view name) {
    return {robot.file.string(), line, name.empty() ? std::string(kind) : fmt::format("{} \"{}\"", kind, name), ""};
}

Error at(Diagnostic place, const Error& error) {
    place.text = error.message;
    return error_of(error.cause, {std::move(place)});
}

/// Adds defects and repairs to `notes`.
Result<mesh::TriMesh> read_body_surface(const Robot& robot, const BodySpec& body, const SurfaceFile& file,
                                        std::vector<std::string>& notes) {
    Result<BodyTriangles> surface = read_triangles(file, robot.unit_m);
    if (!surface) return tl::unexpected(at(place(robot, body.line, "body", body.name), surface.error()));
    for (const std::string& note : surface->notes) notes.push_back(fmt::format("body \"{}\": {}", body.name, note));
    return std::move(surface->mesh);
}

/// Defects and repairs in the surfaces of chambers, which are read again when the model is built.
std::vector<std::string> notes_on_chambers(const Robot& robot) {
    std::vector<std::string> notes;
    for (const ChamberSpec& chamber : robot.chambers) {
        const auto* file = std::get_if<SurfaceFile>(&chamber.air);
        const auto surface = file == nullptr ? Result<mesh::SurfaceFile>() : mesh::read_surface(file->path);
        if (!surface) continue;
        for (const std::string& note : surface->warnings)
            notes.push_back(fmt::format("chamber \"{}\": {}", chamber.name, note));
    }
    return notes;
}

double automatic_size(const std::vector<mesh::BodyGeometry>& bodies) {
    Box3 box;
    for (const auto& body : bodies) {
        const Box3 one = mesh::bounds(body);
        box.add(one.low);
        box.add(one.high);
    }
    return std::max({box.size().x, box.size().y, box.size().z}) / 24;
}

/// The drawn air of all chambers and gaps, which is cut out of the bodies. Enclosed air is already outside them.
std::vector<mesh::Solid> drawn_air(const Robot& robot) {
    std::vector<mesh::Solid> solids;
    for (const Region& region : regions_of(robot)) {
        if (region.use == Region::Use::body) continue;
        const auto* solid = std::get_if<mesh::Solid>(region.geometry);
        if (solid != nullptr && !std::holds_alternative<mesh::EnclosedSolid>((*solid)->shape)) solids.push_back(*solid);
    }
    return solids;
}

/// Where drawn bodies overlap, the later one is printed, just as it is the later one that is meshed.
std::vector<mesh::Solid> cut_from(const Robot& robot, std::size_t body, std::vector<mesh::Solid> air) {
    const auto& own = std::get<mesh::Solid>(robot.bodies[body].geometry);
    for (std::size_t b = body + 1; b < robot.bodies.size(); ++b) {
        const auto* later = std::get_if<mesh::Solid>(&robot.bodies[b].geometry);
        if (later != nullptr && boxes_overlap(mesh::bounds(own), mesh::bounds(*later))) air.push_back(*later);
    }
    return air;
}

/// What later bodies take from a drawn one is cut out exactly: all of them are drawn, too, or there is none.
bool loses_to_drawn_only(const Robot& robot, std::size_t body) {
    return std::all_of(robot.bodies.begin() + static_cast<std::ptrdiff_t>(body), robot.bodies.end(),
                       [](const BodySpec& b) { return std::holds_alternative<mesh::Solid>(b.geometry); });
}

/// A drawn body without the air that is cut out of it.
mesh::Solid without_air(const mesh::Solid& body, const std::vector<mesh::Solid>& air) {
    if (air.empty()) return body;
    mesh::CombinedSolid cut{mesh::CombinedSolid::Operation::subtract, {body}};
    cut.parts.insert(cut.parts.end(), air.begin(), air.end());
    return std::make_shared<const mesh::SolidNode>(mesh::SolidNode{std::move(cut)});
}

/// The common volume of two drawn bodies; 0 where it cannot be measured: what cannot be built is an error of the bodies
/// themselves.
double overlap_of(const mesh::Solid& one, const mesh::Solid& other) {
    const mesh::CombinedSolid both{mesh::CombinedSolid::Operation::intersect, {one, other}};
    return mesh::solid_volume(std::make_shared<const mesh::SolidNode>(mesh::SolidNode{both})).value_or(0);
}

/// Less of it is a rounding error of bodies that touch.
double least_overlap(const mesh::Solid& one, const mesh::Solid& other) {
    const auto volume = [](const Box3& box) { return box.size().x * box.size().y * box.size().z; };
    return 1e-9 * std::min(volume(mesh::bounds(one)), volume(mesh::bounds(other)));
}

using Shape = std::variant<mesh::Solid, mesh::TriMesh>;

/// A body with its air cut out; triangles if nothing is cut, or if there are too many to cut.
Result<Shape> body_shape(const Robot& robot, const BodySpec& body, const std::vector<mesh::Solid>& air,
                         std::vector<std::string>& notes) {
    if (const auto* solid = std::get_if<mesh::Solid>(&body.geometry)) return without_air(*solid, air);
    Result<mesh::TriMesh> surface = read_body_surface(robot, body, std::get<SurfaceFile>(body.geometry), notes);
    if (!surface) return tl::unexpected(surface.error());
    const Box3 box = mesh::bounds(*surface);
    const auto cuts = [&](const mesh::Solid& one) { return boxes_overlap(box, mesh::bounds(one)); };
    const auto fills = [](const CableSpec& cable) { return cable.fill_notches; };
    if (std::any_of(air.begin(), air.end(), cuts) || std::any_of(robot.cables.begin(), robot.cables.end(), fills)) {
        if (Result<mesh::Solid> solid = mesh::polyhedron(*surface)) return without_air(*solid, air);
    }
    return std::move(*surface);
}

/// The file says how long edges are everywhere.
bool has_size(const Robot& robot) {
    return robot.mesh.size > 0 || std::ranges::all_of(robot.bodies, [](const BodySpec& body) { return body.size > 0; });
}

/// The size of what has none of its own.
double general_size(const Robot& robot, const std::vector<mesh::BodyGeometry>& bodies) {
    if (robot.mesh.size > 0) return robot.mesh.size;
    if (!has_size(robot)) return automatic_size(bodies);
    return std::ranges::max(robot.bodies, {}, &BodySpec::size).size;
}

/// The mesher takes the size of its settings as the largest: where a body has a larger size than `general`, the others
/// get that as their own.
Result<mesh::TetMesh> mesh_with_sizes(std::vector<mesh::BodyGeometry> bodies, double general,
                                      mesh::MeshSettings settings, Progress& progress) {
    settings.size = general;
    for (const mesh::BodyGeometry& body : bodies) settings.size = std::max(settings.size, body.size);
    if (settings.size > general) {
        for (mesh::BodyGeometry& body : bodies) body.size = body.size > 0 ? body.size : general;
    }
    return mesh::mesh_bodies(bodies, settings, progress);
}

/// A size in the file is used as given; without one, walls get three elements.
mesh::MeshSettings mesh_settings(const Robot& robot, double size) {
    mesh::MeshSettings settings;
    settings.size = size;
    settings.order = robot.mesh.order;
    settings.through_wall = robot.mesh.elements_through_wall.value_or(has_size(robot) ? 0 : 3);
    settings.judge_walls = !robot.mesh.elements_through_wall;
    settings.close_gaps = robot.mesh.close_gaps.value_or(1e-3 * settings.size);
    settings.size_near_cables = robot.mesh.size_near_cables;
    for (const CableSpec& cable : robot.cables) settings.cables.push_back(cable.points);
    return settings;
}

/// With more nodes a step takes longer than seconds.
constexpr std::size_t most_automatic_nodes = 20000;

/// What the bodies measure; less of them where one cannot be measured, which is told when it is meshed.
std::vector<Bulk> measured(const std::vector<mesh::BodyGeometry>& bodies, double size, Progress& progress) {
    constexpr double chords = 0.05;  // of the size: exact enough to count elements
    std::vector<Bulk> found;
    for (const mesh::BodyGeometry& body : bodies) {
        if (const auto* surface = std::get_if<mesh::TriMesh>(&body.shape)) {
            found.push_back({std::fabs(mesh::signed_volume(*surface)), mesh::surface_area(*surface)});
        } else if (!body.air) {
            const auto drawn = mesh::tessellate(std::get<mesh::Solid>(body.shape), chords * size, progress);
            if (drawn) found.push_back({std::fabs(mesh::signed_volume(*drawn)), mesh::surface_area(*drawn)});
        }
    }
    return found;
}

/// A rough number, without digits that nobody knows.
std::string about(double count) {
    const double step = std::pow(10, std::floor(std::log10(std::max(count, 1.0))) - 1);
    return fmt::format("about {:.0f}", std::round(count / step) * step);
}

std::string coarser_note(std::size_t nodes, const std::string& usual, double size, int through_wall) {
    const bool few = nodes <= most_automatic_nodes;
    return fmt::format(
        "no mesh.size is given: {} nodes in place of {} with 3 elements through every wall, {}; for a {} mesh set "
        "mesh.size (here {:.3g}) or mesh.elements_through_wall (here {})",
        nodes, usual,
        few ? "so that a step takes seconds"
            : fmt::format("still more than the {} with which a step takes seconds", most_automatic_nodes),
        few ? "finer" : "coarser", size, through_wall);
}

mesh::MeshSettings settings_of(const Robot& robot, const Fineness& fineness) {
    mesh::MeshSettings settings = mesh_settings(robot, fineness.size);
    settings.through_wall = fineness.through_wall;
    return settings;
}

/// The next try after a mesh with too many nodes: the walls' elements first, then edges.
Fineness coarser(Fineness fineness, std::size_t nodes) {
    constexpr double most_coarser = 1.6;  // per attempt: notches and walls should still be meshed well
    const double excess = static_cast<double>(nodes) / static_cast<double>(most_automatic_nodes);
    if (fineness.through_wall > 1)
        --fineness.through_wall;
    else
        fineness.size *= std::clamp(std::cbrt(excess), 1.1, most_coarser);
    return fineness;
}

/// The same where the number was foreseen: by as much as it was wrong.
Fineness corrected(std::span<const Bulk> bulk, const Fineness& fineness, std::size_t nodes) {
    constexpr double margin = 0.9;
    const double wrong = static_cast<double>(nodes) / expected_nodes(bulk, fineness);
    return coarsened(bulk, fineness, margin * static_cast<double>(most_automatic_nodes) / wrong);
}

/// If the file gives no size, thin walls and many fingers must not produce a mesh on which every step takes minutes:
/// where the bodies are surely too large for it, a coarser one is made from the start, and a mesh that turns out to
/// have too many nodes is rebuilt with fewer elements through walls and then longer edges. A note says so.
Result<mesh::TetMesh> mesh_within_budget(const Robot& robot, const std::vector<mesh::BodyGeometry>& bodies,
                                         Progress& progress) {
    const double size = general_size(robot, bodies);
    const mesh::MeshSettings settings = mesh_settings(robot, size);
    const bool asked = has_size(robot) || robot.mesh.elements_through_wall || robot.mesh.size_near_cables > 0;
    if (asked) return mesh_with_sizes(bodies, size, settings, progress);
    const std::vector<Bulk> bulk = measured(bodies, size, progress);
    const Fineness usual{size, settings.through_wall, settings.order};
    Fineness taken = within_budget(bulk, usual, most_automatic_nodes);
    const bool foreseen = taken.size > usual.size || taken.through_wall < usual.through_wall;
    Result<mesh::TetMesh> mesh = mesh_with_sizes(bodies, taken.size, settings_of(robot, taken), progress);
    if (!mesh || (!foreseen && mesh->points.size() <= most_automatic_nodes)) return mesh;
    const std::string instead = foreseen ? about(expected_nodes(bulk, usual)) : std::to_string(mesh->points.size());
    const int tries = foreseen ? 1 : 3;
    for (int i = 0; i < tries && mesh && mesh->points.size() > most_automatic_nodes; ++i) {
        const std::size_t nodes = mesh->points.size();
        taken = foreseen ? corrected(bulk, taken, nodes) : coarser(taken, nodes);
        mesh = mesh_with_sizes(bodies, taken.size, settings_of(robot, taken), progress);
    }
    if (mesh) mesh->notes.push_back(coarser_note(mesh->points.size(), instead, taken.size, taken.through_wall));
    return mesh;
}

/// What is cut from a shape, but lies beside it.
bool cuts_nothing(const mesh::Solid& solid) {
    const auto* combined = std::get_if<mesh::CombinedSolid>(&solid->shape);
    if (combined == nullptr) return false;
    if (std::ranges::any_of(combined->parts, cuts_nothing)) return true;
    if (combined->operation != mesh::CombinedSolid::Operation::subtract) return false;
    const Box3 whole = mesh::bounds(combined->parts.front());
    return std::any_of(combined->parts.begin() + 1, combined->parts.end(),
                       [&](const mesh::Solid& part) { return !boxes_meet(whole, mesh::bounds(part)); });
}

/// Notes on what is allowed, but hardly meant.
std::vector<std::string> doubtful(const Robot& robot, const std::vector<mesh::BodyGeometry>& bodies) {
    constexpr double too_coarse = 2;  // sizes of the robot
    std::vector<std::string> notes;
    for (const BodySpec& body : robot.bodies) {
        const auto* solid = std::get_if<mesh::Solid>(&body.geometry);
        if (solid != nullptr && cuts_nothing(*solid))
            notes.push_back(fmt::format(
                "body \"{}\": a shape of a difference lies outside of what it is cut from: it cuts nothing away",
                body.name));
    }
    Box3 box;
    for (const mesh::BodyGeometry& body : bodies) {
        box.add(mesh::bounds(body).low);
        box.add(mesh::bounds(body).high);
    }
    const double longest = std::max({box.size().x, box.size().y, box.size().z});
    if (robot.mesh.size > too_coarse * longest)
        notes.push_back(
            fmt::format("mesh.size, {:.3g}, is {:.3g} times as long as the robot, {:.3g}: it has no effect but that "
                        "its shape is meshed as coarsely as it can be",
                        robot.mesh.size, robot.mesh.size / longest, longest));
    return notes;
}

/// Notes on bodies that stay apart by so little that they were probably drawn to touch. Gaps that close_gaps reaches
/// have notes of their own; who gives it has thought of them.
std::vector<std::string> apart_by_little(const Robot& robot, const mesh::TetMesh& mesh, double closed) {
    constexpr double hardly_seen_m = 20e-6;  // half a usual pixel
    const double tolerance = hardly_seen_m / robot.unit_m;
    if (robot.mesh.close_gaps || closed >= tolerance) return {};
    std::vector<std::string> notes;
    for (const mesh::NarrowGap& gap : mesh::narrow_gaps(mesh, tolerance)) {
        const auto first = static_cast<std::size_t>(gap.first), second = static_cast<std::size_t>(gap.second);
        if (second >= robot.bodies.size() || gap.width <= closed) continue;
        notes.push_back(
            fmt::format("body \"{}\" and \"{}\" are {:.3g} apart at ({:.4g}, {:.4g}, {:.4g}), less than a printer "
                        "shows: they are not joined in the simulation; a larger mesh.close_gaps joins them",
                        robot.bodies[first].name, robot.bodies[second].name, gap.width, gap.at.x, gap.at.y, gap.at.z));
    }
    return notes;
}

Result<mesh::Solid> notches_of(const Robot& robot, const std::vector<mesh::BodyGeometry>& bodies,
                               const std::vector<mesh::Solid>& air) {
    std::vector<mesh::Solid> walls;
    for (const mesh::BodyGeometry& body : bodies) {
        if (body.air) continue;
        if (const auto* solid = std::get_if<mesh::Solid>(&body.shape)) {
            walls.push_back(*solid);
            continue;
        }
        return input_error(
            "{}: fill_notches needs shapes, STEP files or closed surfaces of few flat faces, which \"{}\" is not",
            robot.file.string(), body.name);
    }
    return crossed_notches(robot, walls, air);
}

/// The mesher's error names the body, chamber or gap concerned, if any.
Diagnostic place_of(const Robot& robot, const Error& error) {
    for (const Region& region : regions_of(robot)) {
        if (!error.problems.empty() && error.problems.back().key == region.name)
            return place(robot, region.line, "", "");
    }
    return place(robot, 0, "", "");
}

Result<mesh::TetMesh> mesh_drawn_bodies(const Robot& robot, Progress& progress) {
    const std::vector<mesh::Solid> air = drawn_air(robot);
    std::vector<mesh::BodyGeometry> bodies;
    std::vector<std::string> notes;
    for (const BodySpec& body : robot.bodies) {
        Result<Shape> shape = body_shape(robot, body, air, notes);
        if (!shape) return tl::unexpected(shape.error());
        bodies.push_back({body.name, std::move(*shape), false, body.size});
    }
    for (const Region& region : regions_of(robot)) {
        if (region.use == Region::Use::body) continue;
        const auto* drawn = std::get_if<mesh::Solid>(region.geometry);
        Result<mesh::Solid> space = drawn != nullptr ? *drawn : notches_of(robot, bodies, air);
        if (!space) return tl::unexpected(space.error());
        bodies.push_back({std::string(region.name), std::move(*space), true});
    }
    Result<mesh::TetMesh> mesh = mesh_within_budget(robot, bodies, progress);
    if (!mesh) return tl::unexpected(at(place_of(robot, mesh.error()), mesh.error()));
    const std::vector<std::string> odd = doubtful(robot, bodies);
    notes.insert(notes.end(), odd.begin(), odd.end());
    mesh->notes.insert(mesh->notes.begin(), notes.begin(), notes.end());
    const double closed = mesh_settings(robot, general_size(robot, bodies)).close_gaps;
    const std::vector<std::string> apart = apart_by_little(robot, *mesh, closed);
    mesh->notes.insert(mesh->notes.end(), apart.begin(), apart.end());
    return mesh;
}

bool box_holds_centroid(const BoxSelector& box, const mesh::TetMesh& mesh, std::size_t tet) {
    Vec3 centroid;
    for (std::size_t i = 0; i < 4; ++i) centroid += 0.25 * mesh.points[static_cast<std::size_t>(mesh.tet(tet)[i])];
    return Box3{box.low, box.high}.contains(centroid, 0);
}

/// Assigns to user `u` the tets of its region. A region has one user, but a box may take tets from earlier users.
Status claim_tets(const Robot& robot, const mesh::TetMesh& mesh, const std::vector<Region>& users, std::size_t u,
                  std::vector<int>& user_of_tet) {
    const Region& user = users[u];
    const auto& wanted = std::get<MeshRegion>(*user.geometry);
    const auto wrong = [&](std::string text) {
        return tl::unexpected(at(place(robot, user.line, user.kind, user.name), {Cause::input, std::move(text)}));
    };
    std::size_t found = 0;
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        const std::string& region = mesh.region_names[static_cast<std::size_t>(mesh.region[t])];
        if (wanted.name != "all" && wanted.name != region) continue;
        if (wanted.box && !box_holds_centroid(*wanted.box, mesh, t)) continue;
        ++found;
        if (user_of_tet[t] >= 0 && !wanted.box) {
            const Region& first = users[static_cast<std::size_t>(user_of_tet[t])];
            return wrong(fmt::format("region \"{}\" already belongs to {} \"{}\"", region, first.kind, first.name));
        }
        user_of_tet[t] = static_cast<int>(u);
    }
    if (found > 0) return {};
    if (wanted.box) return wrong("the box holds no centroid of a tetrahedron of the region");
    return wrong(fmt::format("the mesh has no region \"{}\"; it has {}", wanted.name, join_names(mesh.region_names)));
}

/// Assigns every region of a given mesh to the body, chamber or gap that names it.
Result<mesh::TetMesh> give_regions(const Robot& robot, mesh::TetMesh mesh) {
    if (const auto pair = mesh::overlapping_tets(mesh)) {
        if (pair->same)
            return tl::unexpected(
                at(place(robot, robot.mesh.line, "mesh", ""), {Cause::input, mesh::overlap_text(*pair)}));
        mesh.notes.push_back(mesh::overlap_text(*pair));  // as slivers of published meshes do
    }
    const std::vector<Region> users = regions_of(robot);
    std::vector<int> user_of_tet(mesh.tet_count(), -1);
    for (std::size_t u = 0; u < users.size(); ++u) {
        if (Status status = claim_tets(robot, mesh, users, u, user_of_tet); !status)
            return tl::unexpected(status.error());
    }
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        if (user_of_tet[t] < 0) {
            return tl::unexpected(at(place(robot, robot.mesh.line, "mesh", ""),
                                     {Cause::input, fmt::format("no body names region \"{}\" of the mesh",
                                                                mesh.region_names[mesh.region[t]])}));
        }
    }
    mesh.region = std::move(user_of_tet);
    mesh.region_names.clear();
    for (const Region& user : users) mesh.region_names.emplace_back(user.name);
    return robot.mesh.order == 2 ? mesh::to_quadratic(mesh) : std::move(mesh);
}

Result<mesh::TetMesh> read_mesh_file(const Robot& robot) {
    if (*robot.mesh.file == mesh_in_memory)
        return tl::unexpected(at(place(robot, robot.mesh.line, "mesh", ""),
                                 {Cause::input, "file: a mesh in memory can only be given by a program; name a file"}));
    Result<mesh::TetMesh> mesh = mesh::read_tet_mesh(*robot.mesh.file);
    if (!mesh) return tl::unexpected(at(place(robot, robot.mesh.line, "mesh", ""), mesh.error()));
    return give_regions(robot, mesh::placed(std::move(*mesh), robot.mesh.placement));
}

}  // namespace

Result<mesh::TetMesh> build_mesh(const Robot& robot, Progress& progress) {
    Result<mesh::TetMesh> mesh = robot.mesh.file ? read_mesh_file(robot) : mesh_drawn_bodies(robot, progress);
    if (!mesh) return mesh;
    const std::vector<std::string> notes = notes_on_chambers(robot);
    mesh->notes.insert(mesh->notes.end(), notes.begin(), notes.end());
    return mesh::scaled(std::move(*mesh), robot.unit_m);
}

Result<mesh::TetMesh> take_mesh(const Robot& robot, mesh::TetMesh mesh_m) {
    if (!robot.mesh.file)
        return tl::unexpected(
            at(place(robot, robot.mesh.line, "mesh", ""),
               {Cause::input,
                "the bodies are drawn; for a mesh that is given, name regions of it: mesh.file and region"}));
    Result<mesh::TetMesh> mesh =
        give_regions(robot, mesh::placed(mesh::scaled(std::move(mesh_m), 1 / robot.unit_m), robot.mesh.placement));
    return mesh ? mesh::scaled(std::move(*mesh), robot.unit_m) : mesh;
}

Result<std::vector<BodySurface>> body_surfaces(const Robot& robot, Progress& progress) {
    const double tolerance = 10e-6 / robot.unit_m;  // chords may deviate from a curve by a fraction of a pixel
    const std::vector<mesh::Solid> air = drawn_air(robot);
    std::vector<BodySurface> surfaces;
    Result<mesh::TetMesh> regions;
    if (robot.mesh.file) {
        regions = read_mesh_file(robot);
        if (!regions) return tl::unexpected(regions.error());
    }
    for (std::size_t b = 0; b < robot.bodies.size(); ++b) {
        if (progress.cancelled()) return cancelled();
        progress.advance("surfaces", static_cast<double>(b) / static_cast<double>(robot.bodies.size()));
        const BodySpec& body = robot.bodies[b];
        Result<mesh::TriMesh> surface;
        std::vector<std::string> notes;
        if (const auto* solid = std::get_if<mesh::Solid>(&body.geometry)) {
            surface = mesh::tessellate(without_air(*solid, cut_from(robot, b, air)), tolerance, progress);
        } else if (std::holds_alternative<SurfaceFile>(body.geometry)) {
            const Result<Shape> shape = body_shape(robot, body, air, notes);
            if (!shape) return tl::unexpected(shape.error());
            const auto* cut = std::get_if<mesh::Solid>(&*shape);
            surface = cut != nullptr ? mesh::tessellate(*cut, tolerance, progress) : std::get<mesh::TriMesh>(*shape);
        } else {
            surface = mesh::region_surface(*regions, static_cast<int>(b));
        }
        if (!surface && progress.cancelled()) return cancelled();
        if (!surface) return tl::unexpected(at(place(robot, body.line, "body", body.name), surface.error()));
        surfaces.push_back({body.name, body.material, mesh::scaled(std::move(*surface), robot.unit_m), std::move(notes),
                            loses_to_drawn_only(robot, b) ? tolerance * robot.unit_m : 0});
    }
    return surfaces;
}

std::vector<std::string> overlap_notes(const Robot& robot, const Progress& progress) {
    std::vector<std::string> notes;
    const std::vector<mesh::Solid> air = drawn_air(robot);
    for (std::size_t a = 0; a < robot.bodies.size(); ++a) {
        const auto* own = std::get_if<mesh::Solid>(&robot.bodies[a].geometry);
        for (std::size_t b = a + 1; own != nullptr && b < robot.bodies.size() && !progress.cancelled(); ++b) {
            const auto* later = std::get_if<mesh::Solid>(&robot.bodies[b].geometry);
            if (later == nullptr || !boxes_overlap(mesh::bounds(*own), mesh::bounds(*later))) continue;
            const double volume = overlap_of(without_air(*own, air), without_air(*later, air));
            if (volume <= least_overlap(*own, *later)) continue;
            notes.push_back(mesh::overlap_note(robot.bodies[a].name, robot.bodies[b].name, volume));
        }
    }
    return notes;
}

}  // namespace pliant::robot
