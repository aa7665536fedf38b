#include "presentation/scene/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/core/json.hpp"
#include "base/core/share.hpp"
#include "presentation/scene/actuator_kind.hpp"
#include "simulation/material/law_parameters.hpp"
#include "simulation/run/describe.hpp"
#include "simulation/run/fields.hpp"
#include "simulation/run/sensors.hpp"
#include "simulation/run/simulate.hpp"

namespace pliant::view {
namespace {

using Json = nlohmann::json;

constexpr double mm = 1e3;

void append(std::vector<float>& to, const Vec3& p_m) {
    for (const double v : {p_m.x, p_m.y, p_m.z}) to.push_back(static_cast<float>(mm * v));
}

Json vector_json(const Vec3& v) {
    return Json::array({v.x, v.y, v.z});
}

std::string law_text(const robot::MaterialSpec& material) {
    return std::string(material::name(material.law));
}

Json actuator_json(std::string_view type, const std::string& name, std::string_view kind, double value, double rest) {
    return {{"type", type}, {"name", name}, {"kind", kind}, {"target", value}, {"rest", rest}};
}

Json cable_json(const sim::Cable& cable, double rest_m) {
    const ActuatorKind kind = kind_of(cable.target);
    return actuator_json("cable", cable.name, kind.name, kind.per_unit * cable.target.value, mm * rest_m);
}

Json chamber_json(const sim::Chamber& chamber, double rest_m3) {
    const ActuatorKind kind = kind_of(chamber.target);
    return actuator_json("chamber", chamber.name, kind.name, kind.per_unit * chamber.target.value, 1e9 * rest_m3);
}

/// An array with entry(one) for each of the list.
template <class List, class Entry>
Json array_of(const List& list, const Entry& entry) {
    Json array = Json::array();
    for (const auto& one : list) array.push_back(entry(one));
    return array;
}

Json sensor_json(const sim::Sensor& sensor) {
    const Json readings = array_of(sim::readings_of(sensor), [](const auto& reading) -> Json {
        const auto& [name, measure] = reading;
        const sim::Shown as = sim::shown(measure);
        return {{"name", name + std::string(as.suffix)}, {"unit", std::string(as.unit)}};
    });
    return {{"name", sensor.name}, {"readings", readings}};
}

Json graded_json(const std::vector<robot::BodySpec>& bodies) {
    Json graded = Json::array();
    for (const robot::BodySpec& body : bodies) {
        if (body.blend)
            graded.push_back({{"body", body.name}, {"material", body.material}, {"other", body.blend->material}});
    }
    return graded;
}

/// True if something besides actuators acts on the robot.
bool is_loaded(const sim::Description& d) {
    return !d.loads.empty() || !d.pressures.empty() || !d.torques.empty() || norm(d.gravity_m_s2) > 0 ||
           std::ranges::any_of(d.supports, [](const sim::Support& support) { return support.moves(); });
}

double cable_length_m(const sim::Model& model, std::size_t c) {
    const auto cables = sim::cable_points(model, model.mesh().points);
    double length = 0;
    for (std::size_t k = 1; k < cables[c].size(); ++k) length += norm(cables[c][k] - cables[c][k - 1]);
    return length;
}

std::span<const double> flat(std::span<const Vec3> points) {
    static_assert(sizeof(Vec3) == 3 * sizeof(double));
    return {&points.data()->x, 3 * points.size()};
}

std::vector<Vec3> wall_points(const sim::Wall& wall, std::span<const Vec3> positions) {
    std::vector<Vec3> points;
    for (const sim::Attachment& point : wall.points) points.push_back(sim::position(point, flat(positions)));
    return points;
}

double wall_volume(const sim::Wall& wall, const std::vector<Vec3>& positions) {
    const std::vector<Vec3> p = wall_points(wall, positions);
    double volume = 0;
    for (const sim::WallFace& f : wall.faces)
        volume -= dot(p[static_cast<std::size_t>(f[0])],
                      cross(p[static_cast<std::size_t>(f[1])], p[static_cast<std::size_t>(f[2])])) /
                  6;
    return std::abs(volume);
}

Json materials_json(const robot::Robot& robot) {
    Json materials = Json::array();
    for (std::size_t m = 0; m < robot.materials.size(); ++m) {
        const robot::MaterialSpec& spec = robot.materials[m];
        const bool has_modulus = std::ranges::any_of(material::parameters(spec.law),
                                                     [](const auto& p) { return p.name == "youngs_modulus"; });
        materials.push_back({{"name", spec.name},
                             {"colour", report::hex(colour_of(robot, m))},
                             {"law", law_text(spec)},
                             {"from_library", spec.from_library},
                             {"has_youngs_modulus", has_modulus},
                             {"youngs_modulus_MPa", 1e-6 * spec.youngs_modulus_Pa},
                             {"poisson_ratio", spec.poisson_ratio},
                             {"density_kg_m3", spec.density_kg_m3},
                             {"resin", spec.resin}});
    }
    return materials;
}

Json actuators_json(const sim::Model& model) {
    const sim::Description& d = model.description();
    Json actuators = Json::array();
    for (std::size_t c = 0; c < d.cables.size(); ++c)
        actuators.push_back(cable_json(d.cables[c], cable_length_m(model, c)));
    for (const sim::Chamber& chamber : d.chambers)
        actuators.push_back(chamber_json(chamber, wall_volume(chamber.wall, model.mesh().points)));
    for (const sim::Growth& growth : d.growths) actuators[static_cast<std::size_t>(growth.actuator)]["elements"] = true;
    return actuators;
}

/// From `first_object` on they are objects.
Json obstacles_json(const std::vector<report::Obstacle>& obstacles, std::size_t first_object) {
    Json all = Json::array();
    for (std::size_t o = 0; o < obstacles.size(); ++o)
        all.push_back({{"name", obstacles[o].name}, {"open", obstacles[o].open}, {"object", o >= first_object}});
    return all;
}

/// Appends a curved face as four flat ones.
void append_faces(const sim::Wall& wall, std::uint32_t first, std::vector<std::uint32_t>& triangles) {
    for (const sim::WallFace& f : wall.faces) {
        const auto add = [&](int a, int b, int c) {
            for (const int i : {a, b, c}) triangles.push_back(first + static_cast<std::uint32_t>(i));
        };
        if (f[3] < 0) {
            add(f[0], f[1], f[2]);
            continue;
        }
        add(f[0], f[3], f[5]);
        add(f[3], f[1], f[4]);
        add(f[5], f[4], f[2]);
        add(f[3], f[4], f[5]);
    }
}

}  // namespace

bool is_field(const std::string& name) {
    return name == "J" || name == "von_mises" || name == "stretch" || name == "energy";
}

report::Colour colour_of(const robot::Robot& robot, std::size_t material) {
    const auto& own = robot.materials[material].colour;
    return own ? report::Colour{(*own)[0], (*own)[1], (*own)[2]} : report::palette(static_cast<int>(material));
}

Scene::Scene(const robot::Robot& robot, const sim::Model& model) : robot_(robot), model_(model) {
    for (const robot::BodySpec& body : robot.bodies) region_material_.push_back(body.material);
    region_material_.resize(model.mesh().region_names.size(), -1);
    add_materials();
    add_grades();
    sim::Trajectory rest;
    rest.steps.emplace_back();
    rest.steps.back().positions = model.mesh().points;
    obstacles_ = report::obstacles_of(model, rest);
}

/// Each material has a closed surface of its own, so that materials can be cut and drawn separately.
void Scene::add_materials() {
    for (std::size_t m = 0; m < robot_.materials.size(); ++m) {
        std::vector<int> shown = region_material_;
        for (int& material : shown) material = material == static_cast<int>(m) ? material : -1;
        report::Surface part = report::outer_surface(model_.mesh(), shown);
        const auto first = static_cast<int>(surface_.vertex_node.size());
        surface_.vertex_node.insert(surface_.vertex_node.end(), part.vertex_node.begin(), part.vertex_node.end());
        for (const auto& t : part.triangles) surface_.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
        material_.resize(surface_.vertex_node.size(), static_cast<std::uint32_t>(m));
        shown_.push_back(std::move(shown));
        parts_.push_back(std::move(part));
    }
}

/// Graded bodies are drawn with a gradient between the colours of their materials.
void Scene::add_grades() {
    const bool any =
        std::any_of(robot_.bodies.begin(), robot_.bodies.end(), [](auto& b) { return b.blend.has_value(); });
    if (!any) return;
    other_ = material_;
    share_.resize(material_.size());
    std::size_t first = 0;
    for (const report::Surface& part : parts_) {
        for (std::size_t t = 0; t < part.triangles.size(); ++t) {
            const auto body = static_cast<std::size_t>(model_.mesh().region[static_cast<std::size_t>(part.tet[t])]);
            if (body >= robot_.bodies.size() || !robot_.bodies[body].blend) continue;
            const robot::PrintBlend& blend = *robot_.bodies[body].blend;
            for (const int corner : part.triangles[t]) {
                const std::size_t v = first + static_cast<std::size_t>(corner);
                const Vec3& at = model_.mesh().points[static_cast<std::size_t>(surface_.vertex_node[v])];
                other_[v] = static_cast<std::uint32_t>(blend.material);
                share_[v] = static_cast<float>(
                    share_along(blend.shares, robot_.unit_m * blend.from, robot_.unit_m * blend.to, at));
            }
        }
        first += part.vertex_node.size();
    }
}

std::string Scene::head() const {
    const sim::Description& d = model_.description();
    const auto support_name = [](const sim::Support& support) -> Json { return support.name; };
    const auto body = [](const robot::BodySpec& b) -> Json { return {{"name", b.name}, {"material", b.material}}; };
    const auto points_of = [](const sim::Cable& cable) -> Json { return cable.points.size(); };
    const auto marker = [&](const sim::Marker& m) -> Json {
        return {{"name", m.name}, {"rest", vector_json(mm * sim::position(m.point, flat(model_.mesh().points)))}};
    };
    const Json json = {{"robot", robot_.name},
                       {"materials", materials_json(robot_)},
                       {"bodies", array_of(robot_.bodies, body)},
                       {"unit_mm", mm * robot_.unit_m},
                       {"graded", graded_json(robot_.bodies)},
                       {"actuators", actuators_json(model_)},
                       {"cable_points", array_of(d.cables, points_of)},
                       {"supports", array_of(d.supports, support_name)},
                       {"markers", array_of(d.markers, marker)},
                       {"sensors", array_of(d.sensors, sensor_json)},
                       {"obstacles", obstacles_json(obstacles_, obstacles_.size() - model_.objects().size())},
                       {"loaded", is_loaded(d)},
                       {"program",
                        {{"steps", robot_.program.steps},
                         {"duration", robot_.program.duration},
                         {"timed", robot_.program.dynamics.has_value()}}},
                       {"tolerance", robot_.program.tolerance},
                       {"nodes", model_.node_count()},
                       {"tets", model_.mesh().tet_count()},
                       {"order", model_.mesh().order}};
    return json_text(json);
}

std::string Scene::packet(const std::string& extra) const {
    Packet packet;
    std::vector<float> rest;
    for (const int node : surface_.vertex_node) append(rest, model_.mesh().points[static_cast<std::size_t>(node)]);
    std::vector<std::uint32_t> triangles, support(surface_.vertex_node.size(), 0), chamber_triangles;
    for (const auto& t : surface_.triangles)
        for (const int v : t) triangles.push_back(static_cast<std::uint32_t>(v));
    std::vector<std::uint32_t> support_of_node(model_.mesh().points.size(), 0);
    const auto& supports = model_.description().supports;
    for (std::size_t s = 0; s < supports.size(); ++s)
        for (const int node : supports[s].nodes)
            support_of_node[static_cast<std::size_t>(node)] = static_cast<std::uint32_t>(s + 1);
    for (std::size_t v = 0; v < support.size(); ++v)
        support[v] = support_of_node[static_cast<std::size_t>(surface_.vertex_node[v])];
    std::uint32_t first = 0;
    for (const sim::Chamber& chamber : model_.description().chambers) {
        append_faces(chamber.wall, first, chamber_triangles);
        first += static_cast<std::uint32_t>(chamber.wall.points.size());
    }
    packet.add("rest", rest);
    packet.add("triangles", triangles);
    packet.add("material", material_);
    if (!share_.empty()) {
        packet.add("other", other_);
        packet.add("share", share_);
    }
    packet.add("support", support);
    packet.add("chamber_triangles", chamber_triangles);
    for (std::size_t o = 0; o < obstacles_.size(); ++o) {
        std::vector<float> points;
        std::vector<std::uint32_t> faces;
        for (const Vec3& p : obstacles_[o].surface.points) append(points, p);
        for (const auto& t : obstacles_[o].surface.triangles)
            for (const int v : t) faces.push_back(static_cast<std::uint32_t>(v));
        packet.add(fmt::format("obstacle_points_{}", o), points);
        packet.add(fmt::format("obstacle_triangles_{}", o), faces);
    }
    std::string text = head();
    text.insert(text.size() - 1, extra);
    return packet.finish(text);
}

void Scene::add_field(Packet& packet, const std::string& name, const std::vector<double>& tets) const {
    std::vector<float> values;
    for (std::size_t m = 0; m < parts_.size(); ++m) {
        for (const double v : report::at_vertices(model_.mesh(), shown_[m], parts_[m], tets))
            values.push_back(static_cast<float>(v));
    }
    packet.add(name, values);
}

std::string Scene::frame(const sim::Step& step, const std::set<std::string>& fields, const std::string& head) const {
    Packet packet;
    std::vector<float> positions, cables, chambers;
    for (const int node : surface_.vertex_node) append(positions, step.positions[static_cast<std::size_t>(node)]);
    for (const auto& cable : sim::cable_points(model_, step.positions))
        for (const Vec3& p : cable) append(cables, p);
    for (const sim::Chamber& chamber : model_.description().chambers)
        for (const Vec3& p : wall_points(chamber.wall, step.positions)) append(chambers, p);
    packet.add("positions", positions);
    packet.add("cables", cables);
    packet.add("chambers", chambers);
    if (std::any_of(fields.begin(), fields.end(), is_field)) {
        const sim::Fields f = sim::compute_fields(model_, step.positions);
        if (fields.contains("J")) add_field(packet, "J", f.J);
        if (fields.contains("von_mises")) add_field(packet, "von_mises", f.von_mises_Pa);
        if (fields.contains("stretch")) add_field(packet, "stretch", f.max_stretch);
        if (fields.contains("energy")) add_field(packet, "energy", f.energy_density_Pa);
    }
    return packet.finish(head);
}

std::string Scene::obstacle_offsets(double time, std::span<const Vec3> positions) const {
    Json offsets = Json::array();
    if (model_.description().contact) {
        for (const sim::Obstacle& obstacle : model_.description().contact->obstacles)
            offsets.push_back(vector_json(mm * (obstacle.share.at(time) * obstacle.move_m)));
    }
    for (std::size_t k = 0; k < model_.objects().size(); ++k) {
        const sim::ObjectState state = sim::object_state(model_, k, flat(positions));
        const auto& q = state.rotation;
        const report::Obstacle& drawn = obstacles_[obstacles_.size() - model_.objects().size() + k];
        report::Obstacle origin{{}, {{Vec3{}}, {}}, false, {state.position_m - drawn.pivot_m}, {q}, drawn.pivot_m};
        const Vec3 to = mm * origin.points_at(0).front();
        offsets.push_back({to.x, to.y, to.z, q[1], q[2], q[3], q[0]});
    }
    return json_text(offsets);
}

}  // namespace pliant::view
