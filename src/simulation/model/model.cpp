#include "simulation/model/model.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/core/disjoint_sets.hpp"
#include "geometry/mesh/order_in_space.hpp"
#include "simulation/actuators/chamber_surface.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/model/check.hpp"

namespace pliant::sim {
namespace {

/// Stiffness of an object relative to the stiffest material: a load that strains that by 1 % strains the object by less
/// than 0.01 %.
constexpr double object_stiffness = 100;

Status check_attachment(const Attachment& point, int nodes, const std::string& owner) {
    if (point.nodes.size() != point.weights.size())
        return input_error("{}: as many weights as nodes are needed", owner);
    double sum = 0;
    for (const double weight : point.weights) sum += weight;
    for (const int node : point.nodes) {
        if (node < 0 || node >= nodes) return input_error("{}: node {} does not exist", owner, node);
    }
    if (!point.nodes.empty() && !(std::fabs(sum - 1) < 1e-9)) return input_error("{}: weights do not sum to 1", owner);
    if (!is_finite(point.fixed)) return input_error("{}: position is not finite", owner);
    return {};
}

Status check_mesh(const Description& d) {
    const mesh::TetMesh& mesh = d.mesh;
    if (mesh.tet_count() == 0) return input_error("the mesh holds no tetrahedra");
    if (mesh.region.size() != mesh.tet_count()) return input_error("the mesh needs one region per tetrahedron");
    const int nodes = static_cast<int>(mesh.points.size());
    for (const int node : mesh.nodes) {
        if (node < 0 || node >= nodes) return input_error("the mesh names node {}, it has {}", node, nodes);
    }
    for (const Vec3& p : mesh.points) {
        if (!is_finite(p)) return input_error("the mesh holds a point that is not finite");
    }
    for (const int region : mesh.region) {
        if (region < 0 || region >= static_cast<int>(d.material_of_region.size())) {
            return input_error("region {} has no material", region);
        }
    }
    for (const int m : d.material_of_region) {
        if (m < 0 || m >= static_cast<int>(d.materials.size())) return input_error("material {} does not exist", m);
    }
    if (!d.material_of_tet.empty() && d.material_of_tet.size() != mesh.tet_count())
        return input_error("there are materials of {} tets, the mesh has {}", d.material_of_tet.size(),
                           mesh.tet_count());
    for (const int m : d.material_of_tet) {
        if (m < 0 || m >= static_cast<int>(d.materials.size())) return input_error("material {} does not exist", m);
    }
    if (!d.tet_weights.empty() && d.tet_weights.size() != mesh.tet_count())
        return input_error("there are weights of {} tets, the mesh has {}", d.tet_weights.size(), mesh.tet_count());
    for (const double weight : d.tet_weights) {
        if (!(weight > 0) || !std::isfinite(weight)) return input_error("the weight of a tet must be above zero");
    }
    return {};
}

Status check_cable(const Cable& cable, int nodes) {
    const std::string owner = "cable \"" + cable.name + "\"";
    if (cable.points.size() < 2) return input_error("{}: at least two points are needed", owner);
    for (const Attachment& point : cable.points) {
        if (Status status = check_attachment(point, nodes, owner); !status) return status;
    }
    const double value = cable.target.value;
    const bool ratio = cable.target.kind == CableTarget::Kind::length_ratio;
    const bool pushes = cable.target.kind == CableTarget::Kind::tension_N && value < 0;
    if (!std::isfinite(value) || pushes || (ratio && value <= 0))
        return input_error("{}: the target {} is not possible", owner, value);
    return {};
}

Status check_spring(const Spring& spring, int nodes) {
    const std::string owner = "spring \"" + spring.name + "\"";
    if (spring.points.size() < 2) return input_error("{}: at least two points are needed", owner);
    for (const Attachment& point : spring.points) {
        if (Status status = check_attachment(point, nodes, owner); !status) return status;
    }
    if (!(spring.stiffness_N_m > 0) || !std::isfinite(spring.stiffness_N_m))
        return input_error("{}: its stiffness must be above zero", owner);
    if (spring.free_length_m && !(*spring.free_length_m >= 0 && std::isfinite(*spring.free_length_m)))
        return input_error("{}: its free length must not be negative", owner);
    return {};
}

/// Checks that the faces refer to existing points, and that those of a chamber are closed.
Status check_wall(const Wall& wall, bool closed, int nodes, const std::string& owner) {
    if (wall.faces.empty()) return input_error("{}: has no wall", owner);
    for (const Attachment& point : wall.points) {
        if (Status status = check_attachment(point, nodes, owner); !status) return status;
    }
    for (const WallFace& face : wall.faces) {
        for (std::size_t i = 0; i < 6; ++i) {
            const bool none = face[i] == -1 && face[3] == -1 && i >= 3;
            if (!none && (face[i] < 0 || face[i] >= static_cast<int>(wall.points.size())))
                return input_error("{}: a face names point {} of its wall, which does not exist", owner, face[i]);
        }
    }
    if (closed && !is_closed(wall)) return input_error("{}: its wall is not closed", owner);
    return {};
}

Status check_chamber(const Chamber& chamber, int nodes) {
    const std::string owner = "chamber \"" + chamber.name + "\"";
    if (Status status = check_wall(chamber.wall, true, nodes, owner); !status) return status;
    const double value = chamber.target.value;
    using Kind = ChamberTarget::Kind;
    const bool ratio = chamber.target.kind == Kind::volume_ratio || chamber.target.kind == Kind::gas_ratio;
    if (!std::isfinite(value) || (ratio && value <= 0))
        return input_error("{}: the target {} is not possible", owner, value);
    return {};
}

/// The nodes must not be collinear, or the plate could rotate about their line without resistance.
Status check_plates(const Description& d) {
    for (const RigidPlate& plate : d.plates) {
        for (const int node : plate.nodes) {
            if (node < 0 || node >= static_cast<int>(d.mesh.points.size()))
                return input_error("plate \"{}\": node {} does not exist", plate.name, node);
        }
        double area = 0;
        double reach = 0;
        for (std::size_t k = 2; k < plate.nodes.size(); ++k) {
            const Vec3 a = d.mesh.points[plate.nodes[1]] - d.mesh.points[plate.nodes[0]];
            const Vec3 b = d.mesh.points[plate.nodes[k]] - d.mesh.points[plate.nodes[0]];
            area = std::max(area, norm(cross(a, b)));
            reach = std::max({reach, norm(a), norm(b)});
        }
        if (!(area > 1e-6 * reach * reach))
            return input_error("plate \"{}\": needs at least three nodes that are not on one line", plate.name);
    }
    return {};
}

Status check_growths(const Description& d) {
    const auto cables = static_cast<int>(d.cables.size());
    const auto actuators = cables + static_cast<int>(d.chambers.size());
    for (const Growth& growth : d.growths) {
        if (growth.material < 0 || growth.material >= static_cast<int>(d.materials.size()))
            return input_error("a growth names material {} of {}", growth.material, d.materials.size());
        if (growth.actuator < 0 || growth.actuator >= actuators)
            return input_error("a growth names actuator {} of {}", growth.actuator, actuators);
        if (!(growth.weight_Pa > 0) || !std::isfinite(growth.weight_Pa))
            return input_error("a growth needs a weight above zero");
        const auto a = static_cast<std::size_t>(growth.actuator);
        if (growth.actuator >= cables) {
            const auto kind = d.chambers[a - d.cables.size()].target.kind;
            if (kind != ChamberTarget::Kind::volume_ratio && kind != ChamberTarget::Kind::volume_change_m3)
                return input_error("chamber \"{}\": elements take volumes only", d.chambers[a - d.cables.size()].name);
            continue;
        }
        if (d.cables[a].target.kind == CableTarget::Kind::tension_N || d.cables[a].friction > 0)
            return input_error("cable \"{}\": gap elements take neither tension nor friction", d.cables[a].name);
        if (!(growth.length_m > 0) || !(std::fabs(norm(growth.direction) - 1) < 1e-6))
            return input_error("cable \"{}\": a gap needs a direction and a length", d.cables[a].name);
    }
    return {};
}

Status check_loads(const Description& d, int nodes) {
    for (const Load& load : d.loads) {
        const Attachment spread{load.nodes, load.shares, {}};
        if (load.nodes.empty()) return input_error("load \"{}\": acts on nothing", load.name);
        if (Status status = check_attachment(spread, nodes, "load \"" + load.name + "\""); !status) return status;
        if (!is_finite(load.force_N)) return input_error("load \"{}\": the force is not finite", load.name);
    }
    for (const TorqueLoad& load : d.torques) {
        if (load.nodes.size() < 3) return input_error("load \"{}\": a torque needs three nodes", load.name);
        for (const int node : load.nodes) {
            if (node < 0 || node >= nodes) return input_error("load \"{}\": node {} does not exist", load.name, node);
        }
        if (!is_finite(load.torque_Nm)) return input_error("load \"{}\": the torque is not finite", load.name);
    }
    for (const PressureLoad& load : d.pressures) {
        const std::string owner = "load \"" + load.name + "\"";
        if (Status status = check_wall(load.wall, false, nodes, owner); !status) return status;
        if (!std::isfinite(load.pressure_Pa)) return input_error("{}: the pressure is not finite", owner);
    }
    for (const Marker& marker : d.markers) {
        if (Status status = check_attachment(marker.point, nodes, "marker \"" + marker.name + "\""); !status)
            return status;
    }
    return is_finite(d.gravity_m_s2) ? Status{} : input_error("gravity is not finite");
}

Status check_object(const FreeObject& object, int nodes) {
    const std::string owner = "object \"" + object.name + "\"";
    if (!(object.mass_kg > 0) || !std::isfinite(object.mass_kg))
        return input_error("{}: its mass must be above zero", owner);
    if (!(object.friction >= 0) || !std::isfinite(object.friction))
        return input_error("{}: the coefficient of friction must be zero or more", owner);
    if (!is_finite(object.velocity_m_s) || !is_finite(object.angular_velocity_rad_s))
        return input_error("{}: its velocity is not finite", owner);
    for (const int node : object.nodes) {
        if (node < 0 || node >= nodes) return input_error("{}: node {} does not exist", owner, node);
    }
    if (object.surface.triangles.empty()) return input_error("{}: it has no triangles", owner);
    for (const Vec3& p : object.surface.points) {
        if (!is_finite(p)) return input_error("{}: a coordinate is not a number", owner);
    }
    return {};
}

Status check_objects(const Description& d, int nodes) {
    for (const FreeObject& object : d.objects) {
        if (Status status = check_object(object, nodes); !status) return status;
    }
    if (!d.objects.empty() && !d.contact) return input_error("objects need contact");
    for (const PointMass& mass : d.masses) {
        const std::string owner = "mass \"" + mass.name + "\"";
        if (Status status = check_attachment(mass.point, nodes, owner); !status) return status;
        if (mass.point.nodes.empty()) return input_error("{}: must be carried by nodes", owner);
        if (!(mass.mass_kg > 0) || !std::isfinite(mass.mass_kg)) return input_error("{}: must be above zero", owner);
    }
    return {};
}

Status check_joint(const Joint& joint, const Description& d, int nodes) {
    const std::string owner = "joint \"" + joint.name + "\"";
    for (const auto* end : {&joint.first, &joint.second}) {
        for (const Attachment& point : *end) {
            if (Status status = check_attachment(point, nodes, owner); !status) return status;
        }
    }
    const auto is_there = [&](int object) { return object >= -2 && object < static_cast<int>(d.objects.size()); };
    if (!is_there(joint.objects[0]) || !is_there(joint.objects[1]))
        return input_error("{}: names an object that does not exist", owner);
    if (joint.objects == std::array{-2, -2}) return input_error("{}: joins the world to itself", owner);
    if (!(joint.stiffness_N_m > 0) || !std::isfinite(joint.stiffness_N_m) || !(joint.arm_m > 0) ||
        !std::isfinite(joint.arm_m))
        return input_error("{}: its stiffness and its arm must be above zero", owner);
    if (!(joint.law.stiffness >= 0) || !(joint.law.damping >= 0))
        return input_error("{}: stiffness and damping must not be negative", owner);
    if (!(joint.law.low <= joint.law.high)) return input_error("{}: its limits leave no range of motion", owner);
    return {};
}

/// Numbers the free nodes so that neighbours in space are adjacent; nodes that no tet uses count as held, because they
/// have no stiffness.
void number_free_nodes(const Description& d, const HeldNodes& held, std::vector<int>& free_index, int& count) {
    const int nodes = static_cast<int>(d.mesh.points.size());
    std::vector<bool> used(nodes, false);
    for (const int node : d.mesh.nodes) used[node] = true;
    for (const FreeObject& object : d.objects)
        for (const int node : object.nodes) used[node] = true;
    std::vector<int> free;
    for (int node = 0; node < nodes; ++node) {
        if (used[node] && !held.is_fixed(node)) free.push_back(node);
    }
    mesh::order_in_space(free, d.mesh.points, mesh::layer_of(d.mesh));
    count = static_cast<int>(free.size());
    free_index.assign(nodes, -1);
    for (int k = 0; k < count; ++k) free_index[free[k]] = k;
}

/// The nodes of each piece without a held node.
std::vector<std::vector<int>> nodes_of_loose(const mesh::TetMesh& mesh, DisjointSets& pieces,
                                             const std::vector<bool>& held) {
    std::map<std::size_t, std::vector<int>> loose;
    std::vector<bool> seen(mesh.points.size(), false);
    for (const int node : mesh.nodes) {
        const auto n = static_cast<std::size_t>(node);
        if (seen[n] || held[pieces.find(node)]) continue;
        seen[n] = true;
        loose[static_cast<std::size_t>(pieces.find(node))].push_back(node);
    }
    std::vector<std::vector<int>> lists;
    for (auto& [piece, nodes] : loose) {
        std::ranges::sort(nodes);
        lists.push_back(std::move(nodes));
    }
    return lists;
}

/// Every connected piece of the mesh needs a support: a loose piece has no equilibrium by itself. If pieces may be
/// free, `free_pieces` gets the nodes of each.
Status check_held(const Description& d, std::vector<std::vector<int>>& free_pieces) {
    const auto& mesh = d.mesh;
    DisjointSets pieces(mesh.points.size());
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        for (const int node : mesh.tet(t)) pieces.join(node, mesh.tet(t)[0]);
    }
    std::vector<bool> held(mesh.points.size(), false);
    for (const Support& support : d.supports) {
        for (const int node : support.nodes) held[pieces.find(node)] = true;
    }
    std::size_t loose = 0;
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) loose += held[pieces.find(mesh.tet(t)[0])] ? 0 : 1;
    if (loose == 0) return {};
    if (d.may_be_free) {
        free_pieces = nodes_of_loose(mesh, pieces, held);
        return {};
    }
    if (loose == mesh.tet_count()) return input_error("nothing is fixed; add a [[fixed]] that holds the robot");
    return input_error("a piece of {} of the {} tetrahedra is connected to nothing that is fixed", loose,
                       mesh.tet_count());
}

std::vector<double> numbers_of(const std::vector<Vec3>& points) {
    std::vector<double> numbers;
    numbers.reserve(3 * points.size());
    for (const Vec3& p : points) numbers.insert(numbers.end(), {p.x, p.y, p.z});
    return numbers;
}

/// Surface of the tets that carry material; meshed empty space does not take part in contact.
contact::Surface surface_of_bodies(const Description& d) {
    mesh::TetMesh bodies;
    bodies.order = d.mesh.order;
    bodies.points = d.mesh.points;
    for (std::size_t t = 0; t < d.mesh.tet_count(); ++t) {
        const int material = d.material_of_tet.empty()
                                 ? d.material_of_region[static_cast<std::size_t>(d.mesh.region[t])]
                                 : d.material_of_tet[t];
        const auto fills = [&](const Growth& growth) { return growth.material == material; };
        if (std::any_of(d.growths.begin(), d.growths.end(), fills)) continue;
        const std::span<const int> tet = d.mesh.tet(t);
        bodies.nodes.insert(bodies.nodes.end(), tet.begin(), tet.end());
    }
    return contact::robot_surface(bodies);
}

/// Exerts no forces: only used for crossing().
Result<contact::Contact> surfaces_without_contact(const Description& d) {
    return contact::Contact::create(surface_of_bodies(d), {}, {.distance_m = 1, .stiffness_Pa = 1},
                                    numbers_of(d.mesh.points));
}

Result<std::unique_ptr<contact::Contact>> create_contact(const Description& d, const ObjectPoints& points, bool self) {
    const std::vector<double> nodes = numbers_of(d.mesh.points);
    std::vector<double> rest = nodes;
    points.append(nodes, rest);
    std::vector<contact::Obstacle> obstacles;
    for (const Obstacle& obstacle : d.contact->obstacles) {
        obstacles.push_back(obstacle.body);
        obstacles.back().start_m = obstacle.share.at(0) * obstacle.move_m;
    }
    contact::Settings settings = d.contact->settings;
    settings.self = self;
    std::vector<contact::Joined> joined;
    for (const Joint& joint : d.joints) {
        if (joint.objects[0] < -1 || joint.objects[1] < -1) continue;  // to the world
        joined.push_back({joint.objects[0], joint.objects[1], position(joint.first[0], nodes), joint.clear_m});
    }
    auto contact = contact::Contact::create(points.with_objects(d.contact->surface, d.objects), std::move(obstacles),
                                            settings, rest, points.parts(), std::move(joined));
    if (!contact) return tl::unexpected(contact.error());
    return std::make_unique<contact::Contact>(std::move(*contact));
}

/// What the checks find out on their way.
struct Checked {
    HeldNodes held;
    std::vector<std::vector<int>> free_pieces;
};

Result<Checked> checked(const Description& description) {
    const int nodes = static_cast<int>(description.mesh.points.size());
    Status status = check_mesh(description);
    if (status) status = check_loads(description, nodes);
    if (status) status = check_growths(description);
    if (status) status = check_plates(description);
    for (std::size_t c = 0; status && c < description.cables.size(); ++c)
        status = check_cable(description.cables[c], nodes);
    for (std::size_t c = 0; status && c < description.chambers.size(); ++c)
        status = check_chamber(description.chambers[c], nodes);
    for (std::size_t s = 0; status && s < description.springs.size(); ++s)
        status = check_spring(description.springs[s], nodes);
    if (!status) return tl::unexpected(status.error());
    if (status = check_objects(description, nodes); !status) return tl::unexpected(status.error());
    for (const Joint& joint : description.joints)
        if (status = check_joint(joint, description, nodes); !status) return tl::unexpected(status.error());
    Result<HeldNodes> held = HeldNodes::create(description.supports, nodes);
    if (!held) return tl::unexpected(held.error());
    Checked result{std::move(*held), {}};
    if (status = check_held(description, result.free_pieces); !status) return tl::unexpected(status.error());
    return result;
}

}  // namespace

Model::Model() = default;
Model::Model(Model&&) noexcept = default;
Model& Model::operator=(Model&&) noexcept = default;
Model::~Model() = default;

Result<HeldNodes> check(const Description& description) {
    Result<Checked> found = checked(description);
    if (!found) return tl::unexpected(found.error());
    return std::move(found->held);
}

Result<Model> Model::create(Description description) {
    Model model;
    Result<Checked> found = checked(description);
    if (!found) return tl::unexpected(found.error());
    number_free_nodes(description, found->held, model.free_index_, model.free_count_);
    model.held_ = std::make_unique<HeldNodes>(std::move(found->held));
    model.free_pieces_ = std::move(found->free_pieces);
    model.description_ = std::move(description);
    Result<Elements> elements = Elements::create(model.description_);
    if (!elements) return tl::unexpected(elements.error());
    model.elements_ = std::make_unique<Elements>(std::move(*elements));
    model.make_objects();
    if (Status status = model.make_contact(); !status) return tl::unexpected(status.error());
    return model;
}

void Model::make_objects() {
    const Description& d = description_;
    double stiffest = 0;
    for (const Material& material : d.materials) stiffest = std::max(stiffest, material::stiffness_bound(material.law));
    const std::vector<double> rest = numbers_of(d.mesh.points);
    for (const FreeObject& object : d.objects) {
        const double volume = std::fabs(mesh::signed_volume(object.surface));
        objects_.emplace_back(object.nodes, object_stiffness * stiffest * volume, rest);
    }
    object_points_ = ObjectPoints(d.objects, objects_, node_count());
}

Status Model::make_contact() {
    const auto& rules = description_.contact;
    const bool waits = rules && rules->settings.self && rules->self_when_met;
    if (rules && (!waits || !rules->obstacles.empty() || !objects_.empty())) {
        auto contact = create_contact(description_, object_points_, rules->settings.self && !waits);
        if (!contact) return tl::unexpected(contact.error());
        contact_ = std::move(*contact);
    }
    if (waits) {
        auto contact = create_contact(description_, object_points_, true);
        if (!contact) return tl::unexpected(contact.error());
        // Intersections that exist at rest cannot be told from later ones.
        if (!(*contact)->crossing_at_rest()) met_ = std::move(*contact);
    }
    if (contact_ || met_) return {};
    Result<contact::Contact> surfaces = surfaces_without_contact(description_);
    if (!surfaces) return tl::unexpected(surfaces.error());
    surfaces_ = std::make_unique<contact::Contact>(std::move(*surfaces));
    return {};
}

}  // namespace pliant::sim
