#include "presentation/report/gltf.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "base/core/boxes.hpp"
#include "base/core/json.hpp"
#include "presentation/draw/tube.hpp"

namespace pliant::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr double target_budget_bytes = 24e6;
constexpr int float_type = 5126, unsigned_type = 5125;
constexpr int array_buffer = 34962, element_buffer = 34963;

/// Pliant's Z up to glTF's Y up.
Vec3 y_up(const Vec3& v) {
    return {v.x, v.z, -v.y};
}

/// The same conversion for a rotation, w, x, y, z to x, y, z, w.
std::array<float, 4> turn_y_up(const std::array<double, 4>& q) {
    const Vec3 axis = y_up({q[1], q[2], q[3]});
    return {static_cast<float>(axis.x), static_cast<float>(axis.y), static_cast<float>(axis.z),
            static_cast<float>(q[0])};
}

/// The binary chunk and its accessors; every view starts at a multiple of four bytes.
class Buffer {
public:
    /// Returns the accessor's index. `bounds`: writes min and max, which positions and key times must have.
    int vectors(std::span<const Vec3> values, bool bounds, bool vertex_data = true) {
        std::vector<float> data;
        data.reserve(3 * values.size());
        for (const Vec3& v : values) {
            for (std::size_t k = 0; k < 3; ++k) data.push_back(static_cast<float>(v[k]));
        }
        return add(data, float_type, "VEC3", 3, bounds, vertex_data ? array_buffer : 0);
    }
    int scalars(const std::vector<float>& values, bool bounds) {
        return add(values, float_type, "SCALAR", 1, bounds, 0);
    }
    int quaternions(const std::vector<std::array<float, 4>>& values) {
        std::vector<float> data;
        for (const auto& q : values) data.insert(data.end(), q.begin(), q.end());
        return add(data, float_type, "VEC4", 4, false, 0);
    }
    int indices(const std::vector<std::array<int, 3>>& triangles) {
        std::vector<std::uint32_t> data;
        for (const auto& t : triangles) {
            for (const int i : t) data.push_back(static_cast<std::uint32_t>(i));
        }
        return add(data, unsigned_type, "SCALAR", 1, false, element_buffer);
    }

    [[nodiscard]] const std::string& bytes() const { return bytes_; }
    [[nodiscard]] const Json& views() const { return views_; }
    [[nodiscard]] const Json& accessors() const { return accessors_; }

private:
    template <class T>
    int add(const std::vector<T>& data, int component, const char* type, std::size_t width, bool bounds, int target) {
        Json view = {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", data.size() * sizeof(T)}};
        if (target != 0) view["target"] = target;
        bytes_.append(reinterpret_cast<const char*>(data.data()), data.size() * sizeof(T));
        views_.push_back(std::move(view));
        Json accessor = {{"bufferView", views_.size() - 1},
                         {"componentType", component},
                         {"count", data.size() / width},
                         {"type", type}};
        for (std::size_t k = 0; bounds && k < width; ++k) {
            T low = data[k], high = data[k];
            for (std::size_t i = k; i < data.size(); i += width) {
                low = std::min(low, data[i]);
                high = std::max(high, data[i]);
            }
            accessor["min"].push_back(low);
            accessor["max"].push_back(high);
        }
        accessors_.push_back(std::move(accessor));
        return static_cast<int>(accessors_.size()) - 1;
    }

    std::string bytes_;
    Json views_ = Json::array();
    Json accessors_ = Json::array();
};

/// The poses of one primitive: rest and one per morph target.
struct Motion {
    std::vector<std::array<int, 3>> triangles;
    std::vector<Pose> poses;
};

Json primitive_json(Buffer& buffer, const Motion& motion, int material) {
    const Pose& rest = motion.poses.front();
    Json out;
    out["attributes"] = {{"POSITION", buffer.vectors(rest.positions, true)},
                         {"NORMAL", buffer.vectors(rest.normals, false)}};
    out["indices"] = buffer.indices(motion.triangles);
    out["material"] = material;
    for (std::size_t i = 1; i < motion.poses.size(); ++i) {
        Pose delta = motion.poses[i];
        for (std::size_t v = 0; v < delta.positions.size(); ++v) {
            delta.positions[v] -= rest.positions[v];
            delta.normals[v] -= rest.normals[v];
        }
        out["targets"].push_back(
            {{"POSITION", buffer.vectors(delta.positions, true)}, {"NORMAL", buffer.vectors(delta.normals, false)}});
    }
    return out;
}

/// The surface of one material in all poses, with renumbered vertices.
Motion material_motion(const Surface& surface, const std::vector<Pose>& poses, int material) {
    Motion motion;
    std::vector<int> renumbered(surface.vertex_node.size(), -1);
    std::vector<std::size_t> kept;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        if (surface.material[t] != material) continue;
        std::array<int, 3> triangle = surface.triangles[t];
        for (int& v : triangle) {
            int& id = renumbered[static_cast<std::size_t>(v)];
            if (id < 0) {
                id = static_cast<int>(kept.size());
                kept.push_back(static_cast<std::size_t>(v));
            }
            v = id;
        }
        motion.triangles.push_back(triangle);
    }
    for (const Pose& whole : poses) {
        Pose part;
        for (const std::size_t v : kept) {
            part.positions.push_back(y_up(whole.positions[v]));
            part.normals.push_back(y_up(whole.normals[v]));
        }
        motion.poses.push_back(std::move(part));
    }
    return motion;
}

Motion cable_motion(const Simulation& s, std::size_t cable, const std::vector<std::size_t>& steps, double radius) {
    Motion motion;
    for (const std::size_t step : steps) {
        Tube tube = tube_around(s.cable_points[step][cable], radius);
        for (Vec3& p : tube.positions) p = y_up(p);
        for (Vec3& n : tube.normals) n = y_up(n);
        motion.triangles = std::move(tube.triangles);
        motion.poses.push_back({std::move(tube.positions), std::move(tube.normals)});
    }
    return motion;
}

/// A rigid body relative to its centre of rotation; its node is animated.
Motion rigid_motion(const Obstacle& obstacle) {
    const Surface surface = rigid_surface(obstacle.surface);
    Pose rest = pose(surface, obstacle.surface.points);
    for (Vec3& p : rest.positions) p = y_up(p - obstacle.pivot_m);
    for (Vec3& n : rest.normals) n = y_up(n);
    return {surface.triangles, {std::move(rest)}};
}

Json material_json(const std::string& name, const Colour& srgb, double roughness) {
    const Colour c = to_linear(srgb);
    return {{"name", name},
            {"pbrMetallicRoughness",
             {{"baseColorFactor", {c.r, c.g, c.b, 1.0}}, {"metallicFactor", 0.0}, {"roughnessFactor", roughness}}}};
}

/// Key times in [0, duration], strictly increasing as the format requires: proportional to program time or, if that
/// does not increase, evenly spaced.
std::vector<float> key_times(const Simulation& s, const std::vector<std::size_t>& steps, double duration_s) {
    std::vector<float> times, even;
    const double begin = s.result.steps[steps.front()].time, end = s.result.steps[steps.back()].time;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        times.push_back(static_cast<float>(duration_s * (s.result.steps[steps[i]].time - begin) / (end - begin)));
        even.push_back(static_cast<float>(duration_s * static_cast<double>(i) / static_cast<double>(steps.size() - 1)));
    }
    const bool rising =
        std::adjacent_find(times.begin(), times.end(), [](float a, float b) { return !(a < b); }) == times.end();
    return rising ? times : even;
}

/// Animates the weights of one target at a time, so that LINEAR interpolation leads from each kept step to the next.
/// The first `morphed` nodes have targets; the obstacles' nodes follow and are moved.
Json animation_json(Buffer& buffer, const Simulation& s, const std::vector<std::size_t>& steps, double duration_s,
                    std::size_t morphed) {
    std::vector<float> weights;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        for (std::size_t k = 1; k < steps.size(); ++k) weights.push_back(i == k ? 1.0F : 0.0F);
    }
    const int input = buffer.scalars(key_times(s, steps, duration_s), true);
    const int output = buffer.scalars(weights, false);
    Json animation = {{"name", "program"}};
    animation["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", "LINEAR"}});
    for (std::size_t node = 0; node < morphed; ++node) {
        animation["channels"].push_back({{"sampler", 0}, {"target", {{"node", node}, {"path", "weights"}}}});
    }
    const auto move = [&](std::size_t node, const char* path, int output_of_it) {
        animation["channels"].push_back(
            {{"sampler", animation["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
        animation["samplers"].push_back({{"input", input}, {"output", output_of_it}, {"interpolation", "LINEAR"}});
    };
    for (std::size_t k = 0; k < s.obstacles.size(); ++k) {
        const Obstacle& obstacle = s.obstacles[k];
        std::vector<Vec3> places;
        places.reserve(steps.size());
        for (const std::size_t step : steps) places.push_back(y_up(obstacle.offset_m[step] + obstacle.pivot_m));
        move(morphed + k, "translation", buffer.vectors(places, false, false));
        if (obstacle.rotation.empty()) continue;
        std::vector<std::array<float, 4>> turns;
        for (const std::size_t step : steps) turns.push_back(turn_y_up(obstacle.rotation[step]));
        move(morphed + k, "rotation", buffer.quaternions(turns));
    }
    return animation;
}

void append_u32(std::string& out, std::size_t value) {
    for (int shift = 0; shift < 32; shift += 8) out += static_cast<char>(value >> shift & 0xffU);
}

std::string glb(const Json& document, std::string binary) {
    std::string text = json_text(document);
    text.append((4 - text.size() % 4) % 4, ' ');
    binary.append((4 - binary.size() % 4) % 4, '\0');
    std::string out = "glTF";
    append_u32(out, 2);
    append_u32(out, 12 + 8 + text.size() + 8 + binary.size());
    append_u32(out, text.size());
    out += "JSON" + text;
    append_u32(out, binary.size());
    out.append("BIN\0", 4);
    return out + binary;
}

/// Builds meshes, materials and nodes one by one.
class Document {
public:
    Document(const Simulation& s, const Surface& surface, std::vector<std::size_t> steps)
        : s_(s), surface_(surface), steps_(std::move(steps)) {}

    std::string bytes(double animation_s) {
        add_robot();
        add_cables();
        const std::size_t morphed = nodes_.size();
        add_obstacles();
        Json root = {{"asset", {{"version", "2.0"}, {"generator", std::string("Pliant ") + PLIANT_VERSION}}}};
        root["scene"] = 0;
        Json scene = {{"name", s_.robot}};
        for (std::size_t i = 0; i < nodes_.size(); ++i) scene["nodes"].push_back(i);
        root["scenes"].push_back(std::move(scene));
        if (steps_.size() > 1) {
            root["animations"].push_back(animation_json(buffer_, s_, steps_, animation_s, morphed));
        }
        root["nodes"] = nodes_;
        root["meshes"] = meshes_;
        root["materials"] = materials_;
        root["accessors"] = buffer_.accessors();
        root["bufferViews"] = buffer_.views();
        root["buffers"].push_back({{"byteLength", (buffer_.bytes().size() + 3) / 4 * 4}});
        return glb(root, buffer_.bytes());
    }

private:
    void add_robot() {
        std::vector<Pose> poses;
        for (const std::size_t step : steps_) poses.push_back(pose(surface_, s_.result.steps[step].positions));
        for (int m = 0; m < static_cast<int>(s_.materials.size()); ++m) {
            const Motion motion = material_motion(surface_, poses, m);
            if (motion.triangles.empty()) continue;
            const std::string& name = s_.materials[static_cast<std::size_t>(m)].name;
            materials_.push_back(material_json(name, colour_of(s_, m), 0.6));
            add_mesh(name, Json::array({primitive_json(buffer_, motion, static_cast<int>(materials_.size()) - 1)}));
        }
    }

    void add_cables() {
        if (s_.cable_points.empty()) return;
        const double radius = drawn_cable_radius(s_);
        Json primitives = Json::array();
        for (std::size_t c = 0; c < s_.cable_points.front().size(); ++c) {
            if (s_.cable_points.front()[c].size() < 2) continue;
            if (primitives.empty()) materials_.push_back(material_json("cable", cable_colour, 0.4));
            primitives.push_back(
                primitive_json(buffer_, cable_motion(s_, c, steps_, radius), static_cast<int>(materials_.size()) - 1));
        }
        if (!primitives.empty()) add_mesh("cables", std::move(primitives));
    }

    /// One mesh and one animated node for each.
    void add_obstacles() {
        if (s_.obstacles.empty()) return;
        materials_.push_back(material_json("obstacle", obstacle_colour, 0.9));
        materials_.back()["doubleSided"] = true;
        const int material = static_cast<int>(materials_.size()) - 1;
        for (const Obstacle& obstacle : s_.obstacles) {
            Json primitives = Json::array({primitive_json(buffer_, rigid_motion(obstacle), material)});
            meshes_.push_back({{"name", obstacle.name}, {"primitives", std::move(primitives)}});
            nodes_.push_back({{"name", obstacle.name}, {"mesh", meshes_.size() - 1}});
            const Vec3 pivot = y_up(obstacle.pivot_m);
            if (!obstacle.rotation.empty()) nodes_.back()["translation"] = {pivot.x, pivot.y, pivot.z};
        }
    }

    void add_mesh(const std::string& name, Json primitives) {
        Json mesh = {{"name", name}, {"primitives", std::move(primitives)}};
        if (steps_.size() > 1) mesh["weights"] = std::vector<double>(steps_.size() - 1, 0.0);
        meshes_.push_back(std::move(mesh));
        nodes_.push_back({{"name", name}, {"mesh", meshes_.size() - 1}});
    }

    const Simulation& s_;
    const Surface& surface_;
    std::vector<std::size_t> steps_;
    Buffer buffer_;
    Json meshes_ = Json::array(), nodes_ = Json::array(), materials_ = Json::array();
};

}  // namespace

std::vector<std::size_t> thinned_steps(std::size_t count, std::size_t limit) {
    std::vector<std::size_t> kept;
    if (count < 2 || limit == 0) return kept;
    const std::size_t last = count - 1, targets = std::min(limit, last);
    for (std::size_t i = 1; i <= targets; ++i) kept.push_back((i * last + targets / 2) / targets);
    return kept;
}

double drawn_cable_radius(const Simulation& s) {
    return 0.006 * bounds_of(s.mesh.points).diagonal();
}

std::string robot_glb(const Simulation& s, const Surface& surface, std::size_t target_limit, double animation_s) {
    const double bytes_per_target = 24.0 * static_cast<double>(std::max<std::size_t>(surface.vertex_node.size(), 1));
    const auto affordable = static_cast<std::size_t>(std::max(2.0, target_budget_bytes / bytes_per_target));
    std::vector<std::size_t> steps = thinned_steps(s.result.steps.size(), std::min(target_limit, affordable));
    steps.insert(steps.begin(), 0);
    return Document(s, surface, std::move(steps)).bytes(animation_s);
}

}  // namespace pliant::report
