// The only file that includes gmsh.h. Gmsh keeps one global state: every use holds the lock of a Session.
#include "mesh/mesher.hpp"

#include <gmsh.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <numbers>

#include "mesh/surface_check.hpp"
#include "mesh/tet_locator.hpp"

namespace pliant::mesh {
namespace {

namespace occ = gmsh::model::occ;
using Entities = gmsh::vectorpair;  ///< (dimension, tag)

/// A Gmsh model of its own, silent and reproducible.
class Session {
public:
    Session() : lock_(mutex()) {
        gmsh::initialize(0, nullptr, false);
        gmsh::option::setNumber("General.Terminal", 0);
        gmsh::option::setNumber("General.AbortOnError", 2);  // throw
        gmsh::option::setNumber("General.NumThreads", 1);
        gmsh::option::setNumber("Mesh.RandomSeed", 1);
        gmsh::option::setNumber("Mesh.Algorithm", 6);    // frontal Delaunay on surfaces
        gmsh::option::setNumber("Mesh.Algorithm3D", 1);  // Delaunay in volumes
        gmsh::option::setNumber("Mesh.Optimize", 1);
        gmsh::model::add("pliant");
    }
    ~Session() { gmsh::finalize(); }
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

private:
    static std::mutex& mutex() {
        static std::mutex one;
        return one;
    }
    std::lock_guard<std::mutex> lock_;
};

/// Runs `work` in a session; what Gmsh throws becomes an error.
template <class Work>
auto in_session(std::string_view task, const Work& work) -> decltype(work()) {
    const Session session;
    try {
        return work();
    } catch (const std::string& text) {
        return failure("{}: Gmsh says: {}", task, text);
    } catch (const std::exception& error) {
        return failure("{}: Gmsh says: {}", task, error.what());
    } catch (...) {
        return failure("{}: Gmsh failed without a reason", task);
    }
}

/// Turns an expression into Open CASCADE volumes.
struct BuildSolid {
    Entities operator()(const BoxSolid& s) const {
        const Vec3 d = s.high - s.low;
        return {{3, occ::addBox(s.low.x, s.low.y, s.low.z, d.x, d.y, d.z)}};
    }
    Entities operator()(const SphereSolid& s) const {
        return {{3, occ::addSphere(s.center.x, s.center.y, s.center.z, s.radius)}};
    }
    Entities operator()(const CylinderSolid& s) const {
        const Vec3 d = s.to - s.from;
        return {{3, occ::addCylinder(s.from.x, s.from.y, s.from.z, d.x, d.y, d.z, s.radius)}};
    }
    Entities operator()(const PrismSolid& s) const {
        const auto axis = [&](std::size_t k) { return static_cast<std::size_t>(s.axes[k]); };
        std::vector<int> points;
        for (const auto& [u, v] : s.polygon) {
            Vec3 p;
            p[axis(0)] = u;
            p[axis(1)] = v;
            p[axis(2)] = s.from;
            points.push_back(occ::addPoint(p.x, p.y, p.z));
        }
        std::vector<int> lines;
        for (std::size_t i = 0; i < points.size(); ++i)
            lines.push_back(occ::addLine(points[i], points[(i + 1) % points.size()]));
        const int face = occ::addPlaneSurface({occ::addCurveLoop(lines)});
        Vec3 along;
        along[axis(2)] = s.to - s.from;
        Entities out;
        occ::extrude({{2, face}}, along.x, along.y, along.z, out);
        std::erase_if(out, [](const auto& entity) { return entity.first != 3; });
        return out;
    }
    Entities operator()(const CombinedSolid& s) const {
        Entities first = build(s.parts.front());
        Entities others;
        for (std::size_t i = 1; i < s.parts.size(); ++i) {
            Entities part = build(s.parts[i]);
            if (s.operation == CombinedSolid::Operation::intersect)
                first = intersect(first, part);
            else
                others.insert(others.end(), part.begin(), part.end());
        }
        if (first.empty() || others.empty())
            return first.empty() && s.operation == CombinedSolid::Operation::unite ? others : first;
        Entities out;
        std::vector<Entities> map;
        if (s.operation == CombinedSolid::Operation::unite)
            occ::fuse(first, others, out, map);
        else
            occ::cut(first, others, out, map);
        return out;
    }
    Entities operator()(const TranslatedSolid& s) const {
        Entities part = build(s.of);
        if (!part.empty()) occ::translate(part, s.offset.x, s.offset.y, s.offset.z);
        return part;
    }
    Entities operator()(const RotatedSolid& s) const {
        Entities part = build(s.of);
        if (!part.empty())
            occ::rotate(part, s.center.x, s.center.y, s.center.z, s.axis.x, s.axis.y, s.axis.z, s.angle_rad);
        return part;
    }
    Entities operator()(const RepeatedSolid& s) const {
        const Entities first = build(s.of);
        Entities copies;
        for (int k = 1; k < s.count && !first.empty(); ++k) {
            Entities copy;
            occ::copy(first, copy);
            occ::translate(copy, k * s.step.x, k * s.step.y, k * s.step.z);
            copies.insert(copies.end(), copy.begin(), copy.end());
        }
        if (copies.empty()) return first;
        Entities out;
        std::vector<Entities> map;
        occ::fuse(first, copies, out, map);
        return out;
    }

    static Entities build(const Solid& solid) { return std::visit(BuildSolid{}, solid->shape); }

    static Entities intersect(const Entities& a, const Entities& b) {
        Entities out;
        std::vector<Entities> map;
        if (!a.empty() && !b.empty()) occ::intersect(a, b, out, map);
        return out;
    }
};

double mass(const Entities& volumes) {
    double sum = 0;
    for (const auto& [dimension, tag] : volumes) {
        double one = 0;
        if (dimension == 3) occ::getMass(dimension, tag, one);
        sum += one;
    }
    return sum;
}

bool boxes_meet(const Box3& a, const Box3& b, double margin) {
    for (std::size_t i = 0; i < 3; ++i) {
        if (a.low[i] > b.high[i] + margin || b.low[i] > a.high[i] + margin) return false;
    }
    return true;
}

Status check_overlaps(std::span<const BodyGeometry* const> bodies, const std::vector<Entities>& volumes) {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        for (std::size_t j = i + 1; j < bodies.size(); ++j) {
            if (!boxes_meet(bounds(*bodies[i]), bounds(*bodies[j]), 0)) continue;
            Entities a;
            Entities b;
            occ::copy(volumes[i], a);
            occ::copy(volumes[j], b);
            const Entities common = BuildSolid::intersect(a, b);
            const double overlap = mass(common);
            if (!common.empty()) occ::remove(common, true);
            if (overlap > 1e-9 * std::min(mass(volumes[i]), mass(volumes[j]))) {
                return input_error(
                    "bodies \"{}\" and \"{}\" overlap in a volume of {:.6g} (in the file's unit, cubed); cut one from "
                    "the other with difference",
                    bodies[i]->name, bodies[j]->name, overlap);
            }
        }
    }
    return {};
}

/// Order of Gmsh's 10-node tet in ours: its last two mid-edge nodes are swapped.
constexpr std::array<int, 10> gmsh_order = {0, 1, 2, 3, 4, 5, 6, 7, 9, 8};

/// The tets of the current Gmsh model; `body_of_volume` gives regions.
TetMesh collect_tets(const std::map<int, int>& body_of_volume, int order) {
    std::vector<std::size_t> tags;
    std::vector<double> coordinates;
    std::vector<double> parameters;
    gmsh::model::mesh::getNodes(tags, coordinates, parameters, -1, -1, false, false);
    std::map<std::size_t, Vec3> position;
    for (std::size_t i = 0; i < tags.size(); ++i) {
        position[tags[i]] = {coordinates[3 * i], coordinates[3 * i + 1], coordinates[3 * i + 2]};
    }
    TetMesh mesh;
    mesh.order = order;
    std::map<std::size_t, int> index;
    const int type = order == 2 ? 11 : 4;
    const auto width = static_cast<std::size_t>(mesh.nodes_per_tet());
    for (const auto& [volume, body] : body_of_volume) {
        std::vector<std::size_t> elements;
        std::vector<std::size_t> nodes;
        gmsh::model::mesh::getElementsByType(type, elements, nodes, volume);
        for (std::size_t t = 0; t < elements.size(); ++t) {
            for (std::size_t a = 0; a < width; ++a) {
                const std::size_t tag = nodes[t * width + static_cast<std::size_t>(gmsh_order[a])];
                const auto [entry, fresh] = index.try_emplace(tag, static_cast<int>(mesh.points.size()));
                if (fresh) mesh.points.push_back(position[tag]);
                mesh.nodes.push_back(entry->second);
            }
            mesh.region.push_back(body);
        }
    }
    return mesh;
}

/// det dX/db at the corners and mid-edge nodes of a quadratic tet: positive everywhere for a usable element.
bool curved_tets_are_sound(const TetMesh& mesh) {
    constexpr double third = 0.25;
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        const auto n = mesh.tet(t);
        const double straight =
            6 * signed_tet_volume(mesh.points[n[0]], mesh.points[n[1]], mesh.points[n[2]], mesh.points[n[3]]);
        for (int corner = 0; corner < 5; ++corner) {
            std::array<double, 4> b = {third, third, third, third};
            if (corner < 4) {
                b = {0, 0, 0, 0};
                b[static_cast<std::size_t>(corner)] = 1;
            }
            std::array<Vec3, 4> column;  // d X / d b_k
            for (std::size_t k = 0; k < 4; ++k) column[k] = (4 * b[k] - 1) * mesh.points[n[k]];
            for (std::size_t e = 0; e < 6; ++e) {
                const auto [p, q] = std::pair(static_cast<std::size_t>(edge_corners[e][0]),
                                              static_cast<std::size_t>(edge_corners[e][1]));
                column[p] += 4 * b[q] * mesh.points[n[4 + e]];
                column[q] += 4 * b[p] * mesh.points[n[4 + e]];
            }
            const double J = dot(column[1] - column[0], cross(column[2] - column[0], column[3] - column[0]));
            if (!(J > 0.05 * straight)) return false;
        }
    }
    return true;
}

TetMesh straightened(const TetMesh& quadratic) {
    TetMesh linear;
    linear.region = quadratic.region;
    std::map<int, int> index;
    for (std::size_t t = 0; t < quadratic.tet_count(); ++t) {
        for (std::size_t a = 0; a < 4; ++a) {
            const auto [entry, fresh] = index.try_emplace(quadratic.tet(t)[a], static_cast<int>(linear.points.size()));
            if (fresh) linear.points.push_back(quadratic.points[quadratic.tet(t)[a]]);
            linear.nodes.push_back(entry->second);
        }
    }
    return to_quadratic(linear);
}

void set_size(double size) {
    gmsh::option::setNumber("Mesh.MeshSizeMax", size);
    gmsh::option::setNumber("Mesh.MeshSizeMin", 0);
    gmsh::option::setNumber("Mesh.MeshSizeFromPoints", 0);
    gmsh::option::setNumber("Mesh.MeshSizeExtendFromBoundary", 1);
}

TetMesh generate(const std::map<int, int>& body_of_volume, int order) {
    gmsh::model::mesh::generate(3);
    if (order == 1) return collect_tets(body_of_volume, 1);
    gmsh::model::mesh::setOrder(2);
    TetMesh mesh = collect_tets(body_of_volume, 2);
    return curved_tets_are_sound(mesh) ? mesh : straightened(mesh);
}

Result<TetMesh> mesh_solids(std::span<const BodyGeometry* const> bodies, const MeshSettings& settings) {
    return in_session("meshing", [&]() -> Result<TetMesh> {
        std::vector<Entities> volumes;
        for (const BodyGeometry* body : bodies) {
            volumes.push_back(BuildSolid::build(std::get<Solid>(body->shape)));
            if (volumes.back().empty() || mass(volumes.back()) <= 0)
                return input_error("body \"{}\" is empty: nothing is left of it", body->name);
        }
        if (Status status = check_overlaps(bodies, volumes); !status) return tl::unexpected(status.error());
        Entities all;
        std::vector<int> owner;
        for (std::size_t b = 0; b < volumes.size(); ++b) {
            for (const auto& volume : volumes[b]) {
                all.push_back(volume);
                owner.push_back(static_cast<int>(b));
            }
        }
        std::map<int, int> body_of_volume;
        if (all.size() == 1) {
            body_of_volume[all.front().second] = 0;
        } else {
            // Pieces that touch get one common face.
            Entities out;
            std::vector<Entities> map;
            occ::fragment({all.front()}, Entities(all.begin() + 1, all.end()), out, map);
            for (std::size_t i = 0; i < map.size(); ++i) {
                for (const auto& [dimension, tag] : map[i]) {
                    if (dimension == 3) body_of_volume[tag] = owner[i];
                }
            }
        }
        occ::synchronize();
        set_size(settings.size);
        gmsh::option::setNumber("Mesh.MeshSizeFromCurvature", 8);
        gmsh::option::setNumber("Mesh.MeshSizeMin", 0.2 * settings.size);
        return generate(body_of_volume, settings.order);
    });
}

/// Hands a triangle surface to Gmsh, which finds its sharp edges and meshes it anew.
Result<TetMesh> mesh_surface(const BodyGeometry& body, const MeshSettings& settings) {
    const TriMesh& surface = std::get<TriMesh>(body.shape);
    if (Status status = check_closed(surface); !status)
        return input_error("body \"{}\": {}", body.name, status.error().message);
    return in_session("meshing body \"" + body.name + "\"", [&]() -> Result<TetMesh> {
        const int discrete = gmsh::model::addDiscreteEntity(2);
        std::vector<std::size_t> tags;
        std::vector<double> coordinates;
        for (std::size_t i = 0; i < surface.points.size(); ++i) {
            tags.push_back(i + 1);
            coordinates.insert(coordinates.end(), {surface.points[i].x, surface.points[i].y, surface.points[i].z});
        }
        gmsh::model::mesh::addNodes(2, discrete, tags, coordinates);
        std::vector<std::size_t> elements;
        std::vector<std::size_t> nodes;
        for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
            elements.push_back(t + 1);
            for (const int n : surface.triangles[t]) nodes.push_back(static_cast<std::size_t>(n) + 1);
        }
        gmsh::model::mesh::addElementsByType(discrete, 2, elements, nodes);
        gmsh::model::mesh::classifySurfaces(settings.angle_deg * std::numbers::pi / 180, true, true, std::numbers::pi);
        gmsh::model::mesh::createGeometry();
        Entities faces;
        gmsh::model::getEntities(faces, 2);
        std::vector<int> loop;
        for (const auto& [dimension, tag] : faces) loop.push_back(tag);
        const int volume = gmsh::model::geo::addVolume({gmsh::model::geo::addSurfaceLoop(loop)});
        gmsh::model::geo::synchronize();
        set_size(settings.size);
        TetMesh mesh = generate({{volume, 0}}, 1);
        if (mesh.tet_count() == 0) return failure("meshing body \"{}\": no tetrahedra came out", body.name);
        return settings.order == 2 ? to_quadratic(mesh) : mesh;
    });
}

/// Surface bodies are not joined to their neighbours: a mesh where they touch would fall apart unnoticed.
Status check_apart(const TetMesh& one, const std::string& name, const TetMesh& other, const std::string& other_name,
                   double margin) {
    const TetLocator locator(other);
    Box3 box;
    for (const Vec3& p : other.points) box.add(p);
    for (const Vec3& p : one.points) {
        if (!box.contains(p, margin) || locator.locate(p).distance > margin) continue;
        return input_error(
            "body \"{}\" touches or overlaps body \"{}\"; bodies from surface files must stand apart (shapes written "
            "in the robot file may touch)",
            name, other_name);
    }
    return {};
}

void append(TetMesh& mesh, const TetMesh& other, int region) {
    const int offset = static_cast<int>(mesh.points.size());
    mesh.points.insert(mesh.points.end(), other.points.begin(), other.points.end());
    for (const int node : other.nodes) mesh.nodes.push_back(node + offset);
    mesh.region.insert(mesh.region.end(), other.tet_count(), region);
}

Status check_settings(std::span<const BodyGeometry> bodies, const MeshSettings& settings) {
    if (bodies.empty()) return input_error("there is no body to mesh");
    if (!(settings.size > 0)) return input_error("the mesh size must be above zero");
    double volume = 0;
    for (const BodyGeometry& body : bodies) {
        const Vec3 size = bounds(body).size();
        volume += size.x * size.y * size.z;
    }
    constexpr double tets_per_cube = 8.5;  // regular tets of edge 1 in a cube of edge 1
    constexpr double most = 20e6;
    const double estimate = tets_per_cube * volume / std::pow(settings.size, 3);
    if (estimate > most) {
        return input_error(
            "a mesh size of {:.6g} gives about {:.2g} tetrahedra, more than the {:.2g} allowed; take {:.3g} or more",
            settings.size, estimate, most, std::cbrt(tets_per_cube * volume / most));
    }
    return {};
}

/// How many of these triangles look outwards, less those that look inwards, by the solid's own membership.
int outward_votes(const Solid& solid, const TriMesh& surface, std::size_t first, double step) {
    int votes = 0;
    for (std::size_t t = first; t < surface.triangles.size(); ++t) {
        const auto& [a, b, c] = surface.triangles[t];
        const Vec3 normal = cross(surface.points[b] - surface.points[a], surface.points[c] - surface.points[a]);
        if (norm(normal) == 0) continue;
        const Vec3 middle = (surface.points[a] + surface.points[b] + surface.points[c]) / 3;
        const Vec3 offset = (step / norm(normal)) * normal;
        votes += (contains(solid, middle - offset) ? 1 : 0) - (contains(solid, middle + offset) ? 1 : 0);
    }
    return votes;
}

/// The triangles on the faces of `volumes`, turned outwards face by face (Open CASCADE's faces look either way).
TriMesh collect_surface(const Solid& solid, const Entities& volumes) {
    Entities faces;
    gmsh::model::getBoundary(volumes, faces, true, false, false);
    TriMesh surface;
    std::map<std::size_t, int> index;
    const double step = 1e-6 * bounds(solid).diagonal();
    for (const auto& [dimension, tag] : faces) {
        std::vector<std::size_t> elements;
        std::vector<std::size_t> nodes;
        gmsh::model::mesh::getElementsByType(2, elements, nodes, std::abs(tag));
        const std::size_t first = surface.triangles.size();
        for (std::size_t t = 0; t < elements.size(); ++t) {
            std::array<int, 3> triangle{};
            for (std::size_t k = 0; k < 3; ++k) {
                const auto [entry, fresh] =
                    index.try_emplace(nodes[3 * t + k], static_cast<int>(surface.points.size()));
                triangle[k] = entry->second;
                if (!fresh) continue;
                std::vector<double> at;
                std::vector<double> parameter;
                gmsh::model::mesh::getNode(nodes[3 * t + k], at, parameter);
                surface.points.push_back({at[0], at[1], at[2]});
            }
            surface.triangles.push_back(triangle);
        }
        if (outward_votes(solid, surface, first, step) >= 0) continue;
        for (std::size_t t = first; t < surface.triangles.size(); ++t)
            std::swap(surface.triangles[t][1], surface.triangles[t][2]);
    }
    return surface;
}

}  // namespace

Box3 bounds(const BodyGeometry& body) {
    const auto* solid = std::get_if<Solid>(&body.shape);
    return solid != nullptr ? bounds(*solid) : bounds(std::get<TriMesh>(body.shape));
}

Result<TetMesh> mesh_bodies(std::span<const BodyGeometry> bodies, const MeshSettings& settings, Progress& progress) {
    if (Status status = check_settings(bodies, settings); !status) return tl::unexpected(status.error());
    progress.advance("mesh", 0);
    std::vector<const BodyGeometry*> solids;
    std::vector<int> solid_body;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        if (!std::holds_alternative<Solid>(bodies[b].shape)) continue;
        solids.push_back(&bodies[b]);
        solid_body.push_back(static_cast<int>(b));
    }
    std::vector<std::pair<std::string, TetMesh>> pieces;
    TetMesh mesh;
    mesh.order = settings.order;
    if (!solids.empty()) {
        Result<TetMesh> joined = mesh_solids(solids, settings);
        if (!joined) return joined;
        for (int& region : joined->region) region = solid_body[static_cast<std::size_t>(region)];
        pieces.emplace_back(solids.front()->name, *joined);
        mesh = std::move(*joined);
    }
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        if (!std::holds_alternative<TriMesh>(bodies[b].shape)) continue;
        if (progress.cancelled()) return cancelled();
        progress.advance("mesh", static_cast<double>(b) / static_cast<double>(bodies.size()));
        Result<TetMesh> one = mesh_surface(bodies[b], settings);
        if (!one) return one;
        for (const auto& [name, piece] : pieces) {
            Status apart = check_apart(*one, bodies[b].name, piece, name, 0.01 * settings.size);
            if (apart) apart = check_apart(piece, name, *one, bodies[b].name, 0.01 * settings.size);
            if (!apart) return tl::unexpected(apart.error());
        }
        append(mesh, *one, static_cast<int>(b));
        pieces.emplace_back(bodies[b].name, std::move(*one));
    }
    for (const BodyGeometry& body : bodies) mesh.region_names.push_back(body.name);
    progress.advance("mesh", 1);
    return mesh;
}

Result<TriMesh> tessellate(const Solid& solid, double tolerance) {
    return in_session("tessellating", [&]() -> Result<TriMesh> {
        const Entities volumes = BuildSolid::build(solid);
        if (volumes.empty()) return input_error("is empty: nothing is left of it");
        occ::synchronize();
        // Flat faces need no inner points; an arc of radius r within `tolerance` needs about 2 pi / sqrt(8 tolerance /
        // r).
        const double reach = std::max(bounds(solid).diagonal() / 2, tolerance);
        const double segments = std::clamp(2 * std::numbers::pi / std::sqrt(8 * tolerance / reach), 24.0, 720.0);
        set_size(4 * reach);
        gmsh::option::setNumber("Mesh.MeshSizeFromCurvature", segments);
        gmsh::model::mesh::generate(2);
        return collect_surface(solid, volumes);
    });
}

Result<double> solid_volume(const Solid& solid) {
    return in_session("measuring", [&]() -> Result<double> { return mass(BuildSolid::build(solid)); });
}

}  // namespace pliant::mesh
