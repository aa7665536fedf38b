#include "simulation/scene/build_places.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>

#include "base/core/text.hpp"
#include "base/linalg/vectors.hpp"
#include "geometry/files/surface_file.hpp"
#include "geometry/mesh/mass_properties.hpp"
#include "simulation/actuators/loads.hpp"
#include "simulation/scene/object_points.hpp"
#include "simulation/scene/outer_faces.hpp"
#include "simulation/scene/symmetry_planes.hpp"

namespace pliant::robot {
namespace {

/// Distance from a point to a triangle (Ericson, Real-Time Collision Detection, 5.1.5).
double distance_to_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a, ac = c - a, ap = p - a;
    const double d1 = dot(ab, ap), d2 = dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return norm(ap);
    const Vec3 bp = p - b;
    const double d3 = dot(ab, bp), d4 = dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return norm(bp);
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return norm(ap - (d1 / (d1 - d3)) * ab);
    const Vec3 cp = p - c;
    const double d5 = dot(ab, cp), d6 = dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return norm(cp);
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return norm(ap - (d2 / (d2 - d6)) * ac);
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return norm(bp - ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (c - b));
    const double scale = 1 / (va + vb + vc);
    return norm(ap - (vb * scale) * ab - (vc * scale) * ac);
}

std::vector<int> select_on_surface(ModelDraft& draft, const SurfaceSelector& selector, std::string_view kind,
                                   const std::string& name, int line) {
    const Result<mesh::SurfaceFile> file = mesh::read_surface(selector.path);
    std::vector<int> nodes;
    if (!file) {
        draft.problem(line, kind, name, file.error().message);
        return nodes;
    }
    const mesh::TriMesh surface = mesh::scaled(file->mesh, draft.robot.unit_m);
    const Box3 bounds = mesh::bounds(surface);
    for (std::size_t n = 0; n < draft.description.mesh.points.size(); ++n) {
        const Vec3& p = draft.description.mesh.points[n];
        if (!bounds.contains(p, draft.tolerance)) continue;
        const bool near = std::any_of(surface.triangles.begin(), surface.triangles.end(), [&](const auto& t) {
            return distance_to_triangle(p, surface.points[t[0]], surface.points[t[1]], surface.points[t[2]]) <
                   draft.tolerance;
        });
        if (near) nodes.push_back(static_cast<int>(n));
    }
    return nodes;
}

/// The numbers are those of the mesh as it is written to a file: with the air, which the robot itself lacks.
std::vector<int> numbered_nodes(ModelDraft& draft, const NodeSelector& selector, std::string_view kind,
                                const std::string& name, int line) {
    std::vector<int> nodes;
    for (const int number : selector.nodes) {
        const auto n = static_cast<std::size_t>(number);
        if (n >= draft.node_of_whole.size()) {
            draft.problem(line, kind, name,
                          fmt::format("node {} does not exist, the mesh has {}", number, draft.node_of_whole.size()));
            return {};
        }
        if (draft.node_of_whole[n] < 0) {
            draft.problem(line, kind, name, fmt::format("node {} lies in the air of a chamber or gap only", number));
            return {};
        }
        nodes.push_back(draft.node_of_whole[n]);
    }
    return nodes;
}

/// caught_nodes(), with a problem if there are none.
std::vector<int> some_caught_nodes(ModelDraft& draft, const Selector& selector, std::string_view kind,
                                   const std::string& name, int line) {
    const std::size_t before = draft.problems.size();
    std::vector<int> nodes = caught_nodes(draft, selector, kind, name, line);
    if (nodes.empty() && draft.problems.size() == before)
        draft.problem(line, kind, name, "catches no node of the mesh; " + draft.show_bounds());
    return nodes;
}

void add_support(ModelDraft& draft, const FixedSpec& fixed) {
    std::vector<int> nodes = some_caught_nodes(draft, fixed.selector, "fixed", fixed.name, fixed.line);
    constexpr double radians = std::numbers::pi / 180;
    const sim::Turn turn{radians * fixed.rotate_deg, fixed.rotation_axis, draft.robot.unit_m * fixed.rotation_center};
    draft.description.supports.push_back(
        {fixed.name, std::move(nodes), draft.robot.unit_m * fixed.move, fixed.share, turn, fixed.directions});
}

void add_plate(ModelDraft& draft, const PlateSpec& plate) {
    std::vector<int> nodes = some_caught_nodes(draft, plate.selector, "plate", plate.name, plate.line);
    if (!nodes.empty()) draft.description.plates.push_back({plate.name, std::move(nodes)});
}

void add_load_on_faces(ModelDraft& draft, const LoadSpec& load, const Selector& selector, const BodyFaces& of_bodies) {
    const std::size_t before = draft.problems.size();
    std::vector<bool> caught(draft.description.mesh.points.size(), false);
    for (const int node : caught_nodes(draft, selector, "load", load.name, load.line))
        caught[static_cast<std::size_t>(node)] = true;
    std::vector<mesh::Face> faces;
    const auto select_from = [&](const std::vector<mesh::Face>& all) {
        for (const mesh::Face& face : all) {
            const auto inside = [&](std::size_t i) { return caught[static_cast<std::size_t>(face.nodes[i])]; };
            if (inside(0) && inside(1) && inside(2)) faces.push_back(face);
        }
    };
    select_from(of_bodies.outer);
    if (faces.empty()) select_from(of_bodies.inner);
    if (draft.problems.size() > before) return;
    if (faces.empty()) {
        const bool box = std::holds_alternative<BoxSelector>(selector);
        draft.problem(
            load.line, "load", load.name,
            fmt::format("no face of the outer surface lies {}; {}",
                        box ? "inside the box" : "where it acts: all three corners must", draft.show_bounds()));
        return;
    }
    if (load.pressure_Pa) {
        draft.description.pressures.push_back({load.name, pressed_wall(draft, faces), *load.pressure_Pa, load.share});
        return;
    }
    sim::SurfaceShares shares = sim::surface_shares(draft.description.mesh, faces);
    draft.description.loads.push_back(
        {load.name, std::move(shares.nodes), std::move(shares.shares), load.force_N, load.share, std::move(faces)});
}

/// Distributes the load equally to the nodes.
void add_evenly(ModelDraft& draft, const LoadSpec& load, const std::vector<int>& nodes) {
    draft.description.loads.push_back({load.name, nodes,
                                       std::vector<double>(nodes.size(), 1.0 / static_cast<double>(nodes.size())),
                                       load.force_N, load.share});
}

/// Only nodes that belong to tets; others belong to nothing.
void add_load_on_nodes(ModelDraft& draft, const LoadSpec& load, const Selector& selector) {
    const std::vector<int> nodes = some_caught_nodes(draft, selector, "load", load.name, load.line);
    if (!nodes.empty()) add_evenly(draft, load, nodes);
}

/// Applies the load to the sum of `shares[i]` times the attachments of the points.
void add_load_at(ModelDraft& draft, const LoadSpec& load, const std::vector<sim::Attachment>& points,
                 const std::vector<double>& shares) {
    std::map<int, double> sum;
    for (std::size_t i = 0; i < points.size(); ++i) {
        for (std::size_t a = 0; a < points[i].nodes.size(); ++a)
            sum[points[i].nodes[a]] += shares[i] * points[i].weights[a];
    }
    sim::Load made{load.name, {}, {}, load.force_N, load.share};
    for (const auto& [node, share] : sum) {
        made.nodes.push_back(node);
        made.shares.push_back(share);
    }
    draft.description.loads.push_back(std::move(made));
}

void add_load_at_points(ModelDraft& draft, const sim::Attacher& attacher, const LoadSpec& load,
                        const LoadPoints& place) {
    std::vector<sim::Attachment> points;
    for (const Vec3& point : place.points) {
        const Place where{"load", "loads", load.name, load.line, place.radius * draft.robot.unit_m, load.force_N};
        auto on = carried(draft, attacher, point, where);
        if (!on) return;
        points.push_back(*std::move(on));
    }
    add_load_at(draft, load, points, std::vector<double>(points.size(), 1.0 / static_cast<double>(points.size())));
}

/// By the two-point Gauss rule on pieces that are short compared with a tet: exact for linear functions along the line,
/// so that force and moment are correct.
void add_load_on_line(ModelDraft& draft, const sim::Attacher& attacher, const LoadSpec& load, const LoadLine& line) {
    const double edge =
        std::cbrt(mesh::volume(draft.bodies) / static_cast<double>(draft.bodies.tet_count())) / draft.robot.unit_m;
    double length = 0;
    for (std::size_t i = 1; i < line.points.size(); ++i) length += norm(line.points[i] - line.points[i - 1]);
    std::vector<sim::Attachment> points;
    std::vector<double> shares;
    for (std::size_t i = 1; i < line.points.size(); ++i) {
        const Vec3 way = line.points[i] - line.points[i - 1];
        const int pieces = static_cast<int>(std::clamp(std::ceil(4 * norm(way) / edge), 1.0, 1e4));
        for (int k = 0; k < 2 * pieces; ++k) {
            const double at = k / 2 + 0.5 + (k % 2 == 0 ? -0.5 : 0.5) / std::numbers::sqrt3;
            const Place where{"load", "loads", load.name, load.line, 0};
            auto on = carried(draft, attacher, line.points[i - 1] + at / pieces * way, where);
            if (!on) return;
            points.push_back(*std::move(on));
            shares.push_back(norm(way) / length / (2 * pieces));
        }
    }
    add_load_at(draft, load, points, shares);
}

/// On nodes that move as one.
void add_load_on_rigid(ModelDraft& draft, const LoadSpec& load, const std::vector<int>& nodes) {
    if (!(load.force_N == Vec3{})) add_evenly(draft, load, nodes);
    if (!(load.torque_Nm == Vec3{}))
        draft.description.torques.push_back({load.name, nodes, load.torque_Nm, load.share});
}

/// Finds the thing that the load names; the problem message lists those that exist.
template <class Thing>
const Thing* find_rigid(ModelDraft& draft, const LoadSpec& load, std::string_view kind,
                        const std::vector<Thing>& things) {
    const std::string& name = std::get<LoadOnRigid>(load.place).name;
    std::vector<std::string> names;
    for (const Thing& thing : things) {
        if (thing.name == name) return &thing;
        names.push_back(thing.name);
    }
    draft.problem(
        load.line, "load", load.name,
        fmt::format("there is no {} \"{}\"{}", kind, name, names.empty() ? "" : "; there is " + join_names(names)));
    return nullptr;
}

void add_load(ModelDraft& draft, const sim::Attacher& attacher, const LoadSpec& load, const BodyFaces& of_bodies) {
    if (const auto* selector = std::get_if<Selector>(&load.place))
        return add_load_on_faces(draft, load, *selector, of_bodies);
    if (const auto* nodes = std::get_if<LoadOnNodes>(&load.place))
        return add_load_on_nodes(draft, load, nodes->selector);
    if (const auto* points = std::get_if<LoadPoints>(&load.place))
        return add_load_at_points(draft, attacher, load, *points);
    if (const auto* line = std::get_if<LoadLine>(&load.place)) return add_load_on_line(draft, attacher, load, *line);
    if (std::get<LoadOnRigid>(load.place).object) return;
    if (const auto* plate = find_rigid(draft, load, "plate", draft.description.plates))
        add_load_on_rigid(draft, load, plate->nodes);
}

/// Four masses with the given centre and inertia (mesh::equal_mass_points), on a frame of the material.
void add_rigid_mass(ModelDraft& draft, const sim::AttachedFrame& frame, const MassSpec& spec) {
    mesh::MassProperties body;
    body.volume = spec.mass_kg;
    const Vec3 arm = draft.robot.unit_m * (spec.center.value_or(spec.point) - spec.point);
    body.centre = arm;
    Eigen::Matrix3d axes;
    axes.col(0) = linalg::vector(spec.axes[0]);
    axes.col(1) = linalg::vector(spec.axes[1]);
    axes.col(2) = axes.col(0).cross(axes.col(1));
    const Eigen::Vector3d I = linalg::vector(spec.inertia_kg_m2);
    const Eigen::Vector3d second = (0.5 * I.sum() - I.array()).max(0.0);  // of x^2, y^2, z^2 along the axes
    body.second_moment = axes * second.asDiagonal() * axes.transpose();
    for (const Vec3& at : mesh::equal_mass_points(body))
        draft.description.masses.push_back({spec.name, frame.at(at), spec.mass_kg / 4});
}

void add_mass(ModelDraft& draft, const sim::Attacher& attacher, const MassSpec& spec) {
    const double radius = spec.radius * draft.robot.unit_m;
    const Place where{"mass", "masses", spec.name, spec.line, radius};
    auto point = carried(draft, attacher, spec.point, where);
    if (!point) return;
    if (spec.inertia_kg_m2 == Vec3{} && !spec.center) {
        draft.description.masses.push_back({spec.name, *std::move(point), spec.mass_kg});
        return;
    }
    const auto frame = attacher.frame(draft.robot.unit_m * spec.point, radius, draft.point_reach);
    if (frame) return add_rigid_mass(draft, *frame, spec);
    draft.problem(spec.line, "mass", spec.name,
                  "something with a center or inertia of its own is glued to a body, not to an object: give the object "
                  "its mass and shape");
}

void add_marker(ModelDraft& draft, const sim::Attacher& attacher, const MarkerSpec& spec) {
    if (const auto* point = std::get_if<Vec3>(&spec.place)) {
        if (auto place = carried(draft, attacher, *point, {"marker", "markers", spec.name, spec.line, 0}))
            draft.description.markers.push_back({spec.name, *std::move(place)});
        return;
    }
    const Box3 box = draft.box_of(std::get<BoxSelector>(spec.place));
    std::vector<bool> corner(draft.description.mesh.points.size(), false);
    for (std::size_t t = 0; t < draft.bodies.tet_count(); ++t) {
        for (std::size_t a = 0; a < 4; ++a) corner[draft.bodies.tet(t)[a]] = true;
    }
    sim::Attachment mean;
    for (std::size_t n = 0; n < corner.size(); ++n) {
        if (corner[n] && box.contains(draft.description.mesh.points[n], draft.box_margin))
            mean.nodes.push_back(static_cast<int>(n));
    }
    if (mean.nodes.empty()) {
        draft.problem(spec.line, "marker", spec.name,
                      "the box holds no corner node of the mesh; " + draft.show_bounds());
        return;
    }
    mean.weights.assign(mean.nodes.size(), 1.0 / static_cast<double>(mean.nodes.size()));
    draft.description.markers.push_back({spec.name, std::move(mean)});
}

}  // namespace

std::optional<sim::Attachment> carried(ModelDraft& draft, const sim::Attacher& attacher, const Vec3& point,
                                       const Place& what) {
    const Vec3 place = draft.robot.unit_m * point;
    if (auto on_object = carried_by_object(draft, attacher, place)) return on_object;
    std::vector<sim::SymmetryPlane> planes;  // of no use where one tet carries the point
    if (what.radius_m > 0) planes = planes_of_force(draft.description, place, what.force_N);
    Result<sim::Attachment> attachment = attacher.spread(place, what.radius_m, draft.point_reach, planes);
    const double distance = attacher.distance_outside(place);
    if (!attachment) {
        draft.problem(what.line, what.kind, what.name,
                      fmt::format("the point {} lies outside every body, by {:.3g} mm; {}", draft.show(place),
                                  1e3 * distance, draft.show_bounds()));
        return std::nullopt;
    }
    draft.count_point(what.kinds, distance);
    return std::move(*attachment);
}

bool are_held(const sim::Description& description, std::span<const sim::Attachment> points) {
    std::set<int> held;
    for (const sim::Support& support : description.supports)
        if (support.directions.empty()) held.insert(support.nodes.begin(), support.nodes.end());
    return std::ranges::all_of(points, [&](const sim::Attachment& point) {
        return std::ranges::all_of(point.nodes, [&](int node) { return held.contains(node); });
    });
}

std::vector<int> caught_nodes(ModelDraft& draft, const Selector& selector, std::string_view kind,
                              const std::string& name, int line) {
    const auto& points = draft.description.mesh.points;
    std::vector<int> nodes;
    const auto collect = [&](const auto& inside) {
        for (std::size_t n = 0; n < points.size(); ++n) {
            if (inside(points[n])) nodes.push_back(static_cast<int>(n));
        }
    };
    if (const auto* box = std::get_if<BoxSelector>(&selector)) {
        collect([&, b = draft.box_of(*box)](const Vec3& p) { return b.contains(p, draft.box_margin); });
    } else if (const auto* plane = std::get_if<PlaneSelector>(&selector)) {
        const Vec3 normal = plane->normal / norm(plane->normal);
        collect([&](const Vec3& p) {
            return std::fabs(dot(normal, p - draft.robot.unit_m * plane->point)) < draft.tolerance;
        });
    } else if (const auto* sphere = std::get_if<SphereSelector>(&selector)) {
        collect([&](const Vec3& p) {
            return norm(p - draft.robot.unit_m * sphere->center) <=
                   draft.robot.unit_m * sphere->radius + draft.box_margin;
        });
    } else if (const auto* surface = std::get_if<SurfaceSelector>(&selector)) {
        nodes = select_on_surface(draft, *surface, kind, name, line);
    } else {
        nodes = numbered_nodes(draft, std::get<NodeSelector>(selector), kind, name, line);
    }
    return nodes;
}

sim::Wall pressed_wall(const ModelDraft& draft, std::vector<mesh::Face> faces) {
    for (mesh::Face& face : faces) {
        std::swap(face.nodes[1], face.nodes[2]);
        std::swap(face.nodes[3], face.nodes[5]);
    }
    std::vector<int> same(draft.description.mesh.points.size());
    std::iota(same.begin(), same.end(), 0);
    return sim::wall_of_faces(draft.description.mesh, faces, same);
}

void add_supports(ModelDraft& draft) {
    for (const FixedSpec& fixed : draft.robot.fixed) add_support(draft, fixed);
}

void add_plates(ModelDraft& draft) {
    for (const PlateSpec& plate : draft.robot.plates) add_plate(draft, plate);
}

void add_loads(ModelDraft& draft, const sim::Attacher& attacher) {
    const auto on_faces = [](const LoadSpec& load) { return std::holds_alternative<Selector>(load.place); };
    BodyFaces of_bodies;
    if (std::ranges::any_of(draft.robot.loads, on_faces)) of_bodies = body_faces(draft);
    for (const LoadSpec& load : draft.robot.loads) add_load(draft, attacher, load, of_bodies);
}

void add_loads_on_objects(ModelDraft& draft) {
    for (const LoadSpec& load : draft.robot.loads) {
        const auto* rigid = std::get_if<LoadOnRigid>(&load.place);
        if (rigid == nullptr || !rigid->object) continue;
        if (const auto* object = find_rigid(draft, load, "object", draft.description.objects))
            add_load_on_rigid(draft, load, {object->nodes.begin(), object->nodes.end()});
    }
}

void add_masses(ModelDraft& draft, const sim::Attacher& attacher) {
    for (const MassSpec& mass : draft.robot.masses) add_mass(draft, attacher, mass);
}

void add_markers(ModelDraft& draft, const sim::Attacher& attacher) {
    for (const MarkerSpec& marker : draft.robot.markers) add_marker(draft, attacher, marker);
}

}  // namespace pliant::robot
