#include "simulation/scene/number_models.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/core/boxes.hpp"
#include "robot/bodies/shape_motion.hpp"
#include "simulation/scene/build_description.hpp"
#include "simulation/scene/build_model.hpp"

namespace pliant::robot {
namespace {

/// Two robots, read with the number half a step larger and smaller.
struct Pair {
    Robot more, less;
    double step = 0;
};

using ReadRobot = std::function<Result<Robot>(const std::vector<std::string>& assignments)>;

Result<Pair> read_around(const ReadRobot& read, const std::string& parameter, double value, double half) {
    const double high = value + half, low = value - half;
    Result<Robot> more = read({fmt::format("parameters.{}={:.17g}", parameter, high)});
    if (!more) return tl::unexpected(more.error());
    Result<Robot> less = read({fmt::format("parameters.{}={:.17g}", parameter, low)});
    if (!less) return tl::unexpected(less.error());
    return Pair{std::move(*more), std::move(*less), high - low};
}

mesh::TetMesh moved(mesh::TetMesh mesh, const std::vector<Vec3>& motion, double by) {
    for (std::size_t n = 0; n < mesh.points.size(); ++n) mesh.points[n] = mesh.points[n] + by * motion[n];
    return mesh;
}

double fastest(const std::vector<Vec3>& motion) {
    double most = 0;
    for (const Vec3& v : motion) most = std::max(most, norm(v));
    return most;
}

double size_of(const mesh::TetMesh& mesh) {
    return bounds_of(mesh.points).diagonal();
}

/// Nodes that something in the file selects, and what to say if the number changes them.
struct Selection {
    std::string blame;
    std::vector<int> nodes;
};

/// Of all faces, one after the other, so that other faces of the same nodes are noticed too.
std::vector<int> nodes_of(const sim::Wall& wall) {
    std::vector<int> nodes;
    for (const sim::WallFace& face : wall.faces) {
        for (const int point : face) {
            if (point < 0) continue;
            const auto& attached = wall.points[static_cast<std::size_t>(point)].nodes;
            nodes.insert(nodes.end(), attached.begin(), attached.end());
        }
    }
    return nodes;
}

std::vector<Selection> selections(const sim::Description& d) {
    std::vector<Selection> all;
    const auto add = [&](fmt::format_string<const std::string&> blame, const std::string& name,
                         std::vector<int> nodes) {
        all.push_back({fmt::format(blame, name), std::move(nodes)});
    };
    for (const sim::Support& support : d.supports)
        add("it decides which nodes \"{}\" holds; let the box of the support follow it", support.name, support.nodes);
    for (const sim::Load& load : d.loads)
        add("it decides where load \"{}\" acts; let the box of the load follow it", load.name, load.nodes);
    for (const sim::PressureLoad& load : d.pressures)
        add("it decides where load \"{}\" acts; let the box of the load follow it", load.name, nodes_of(load.wall));
    for (const sim::Chamber& chamber : d.chambers)
        add("it decides which faces chamber \"{}\" has", chamber.name, nodes_of(chamber.wall));
    for (const sim::RigidPlate& plate : d.plates)
        add("it decides which nodes plate \"{}\" holds; let the box of the plate follow it", plate.name, plate.nodes);
    for (const sim::Sensor& sensor : d.sensors) {
        if (const auto* patch = std::get_if<sim::ContactSensor>(&sensor.what))
            add("it decides which nodes sensor \"{}\" has; let the box of the sensor follow it", sensor.name,
                patch->nodes);
    }
    return all;
}

/// Checks that what must not differ is equal.
Status check_alike(const sim::Model& more, const sim::Model& less) {
    const sim::Description &a = more.description(), &b = less.description();
    const std::vector<Selection> of_more = selections(a), of_less = selections(b);
    for (std::size_t s = 0; s < of_more.size() && s < of_less.size(); ++s) {
        if (of_more[s].nodes != of_less[s].nodes) return input_error("{}", of_more[s].blame);
    }
    const auto is_held = [](int free) { return free < 0; };
    const bool alike = of_more.size() == of_less.size() && a.supports.size() == b.supports.size() &&
                       std::ranges::equal(more.free_index(), less.free_index(), {}, is_held, is_held) &&
                       a.cables.size() == b.cables.size() && a.chambers.size() == b.chambers.size() &&
                       a.markers.size() == b.markers.size();
    if (!alike) return input_error("it decides what the robot consists of");
    return {};
}

}  // namespace

Result<NumberModels> number_models(const ReadRobot& read, const Robot& robot, const mesh::TetMesh& mesh,
                                   const std::string& parameter, double value) {
    const auto refused = [&](const Error& error) {
        return input_error("parameter {} has no derivative: {}", parameter, error.message);
    };
    const double scale = value != 0 ? std::fabs(value) : 1;
    constexpr double of_shape = 1e-4, of_number = 1e-6, of_size = 1e-7;
    const Result<Pair> drawn = read_around(read, parameter, value, of_shape * scale);
    if (!drawn) return refused(drawn.error());
    auto motion = shape_motion(robot, {drawn->more, drawn->less, drawn->step}, mesh);
    if (!motion) return refused(motion.error());
    // The step is small enough that a support's box contains the same nodes, and large enough to limit rounding errors.
    const double speed = fastest(*motion);
    const double half = speed > 0 ? std::min(of_number * scale, of_size * size_of(mesh) / speed) : of_number * scale;
    const Result<Pair> pair = read_around(read, parameter, value, half);
    if (!pair) return refused(pair.error());
    sim::KeptPatches kept;
    if (const auto here = build_description(robot, mesh, &kept); !here) return refused(here.error());
    kept.close();
    Result<sim::Model> more = build_model(pair->more, moved(mesh, *motion, 0.5 * pair->step), &kept);
    if (!more) return refused(more.error());
    Result<sim::Model> less = build_model(pair->less, moved(mesh, *motion, -0.5 * pair->step), &kept);
    if (!less) return refused(less.error());
    if (Status status = check_alike(*more, *less); !status) return refused(status.error());
    return NumberModels{std::move(*more), std::move(*less), pair->step, std::move(*motion)};
}

}  // namespace pliant::robot
