#include <utility>

#include "simulation/contact/friction.hpp"
#include "simulation/stepper/cbor_numbers.hpp"
#include "simulation/stepper/state_digest.hpp"
#include "simulation/stepper/state_file.hpp"

namespace pliant::sim {
namespace {

using cbor::Json;
using cbor::packed;

Json json_of(const State& state) {
    return {{"x", packed(state.x)}, {"multiplier", packed(state.multiplier)}};
}

Json json_of(const std::vector<Drive>& drives) {
    std::vector<int> kinds;
    std::vector<double> values;
    for (const Drive& drive : drives) {
        kinds.push_back(static_cast<int>(drive.kind));
        values.push_back(drive.value);
    }
    return {{"kind", packed(std::span<const int>(kinds))}, {"value", packed(std::span<const double>(values))}};
}

Json json_of(const Inputs& inputs) {
    return {{"time", inputs.time},
            {"drives", json_of(inputs.drives)},
            {"force_N", packed(Eigen::VectorXd(inputs.force_N))}};
}

Json json_of(const History& history) {
    Json json{{"x", packed(history.x)},
              {"v", packed(history.v)},
              {"x_before", packed(history.x_before)},
              {"v_before", packed(history.v_before)},
              {"dt_before", history.dt_before}};
    if (history.touching > 0) json["touching"] = history.touching;
    if (history.next_dt > 0) json["next_dt"] = history.next_dt;
    return json;
}

Json json_of(const contact::Friction& friction) {
    std::vector<int> whole;
    std::vector<double> real, faces;
    bool has_faces = false;
    for (const contact::FrozenPair& pair : friction.pairs()) {
        faces.push_back(static_cast<double>(pair.flat_face));
        has_faces = has_faces || pair.flat_face >= 0;
        whole.insert(whole.end(), pair.nodes.begin(), pair.nodes.end());
        whole.insert(whole.end(), {pair.node_count, pair.first_count, pair.obstacle, pair.robot_first ? 1 : 0});
        real.insert(real.end(), pair.weights.begin(), pair.weights.end());
        for (const Vec3& t : pair.tangents) real.insert(real.end(), {t.x, t.y, t.z});
        real.insert(real.end(), {pair.limit_N, pair.carried_m[0], pair.carried_m[1]});
    }
    Json json{{"pairs", packed(std::span<const int>(whole))},
              {"numbers", packed(std::span<const double>(real))},
              {"start", packed(friction.start())},
              {"slip_m", friction.slip_m()}};
    if (has_faces) json["flat_faces"] = packed(std::span<const double>(faces));
    return json;
}

/// Nine numbers for each object.
Json json_of(const std::vector<linalg::Matrix3>& stress) {
    std::vector<double> numbers;
    for (const linalg::Matrix3& one : stress) numbers.insert(numbers.end(), one.data(), one.data() + one.size());
    return packed(std::span<const double>(numbers));
}

Json json_of(const Controls& controls) {
    Json shares = Json::array();
    for (const auto& list : controls.shares) shares.push_back(packed(std::span<const double>(list)));
    Json json{{"time", controls.time},
              {"external_N", packed(controls.external_N)},
              {"support_share", packed(std::span<const double>(controls.support_share))},
              {"drives", json_of(controls.drives)},
              {"shares", std::move(shares)},
              {"obstacles", packed(controls.obstacles)},
              {"joint_wanted", packed(std::span<const double>(controls.joint_wanted))},
              {"joint_start", packed(std::span<const double>(controls.joint_start))},
              {"met", controls.met}};
    if (!controls.torque_Nm.empty()) {
        Eigen::VectorXd torques(3 * static_cast<Eigen::Index>(controls.torque_Nm.size()));
        for (std::size_t k = 0; k < controls.torque_Nm.size(); ++k)
            torques.segment<3>(3 * static_cast<Eigen::Index>(k)) = controls.torque_Nm[k];
        json["torque_Nm"] = packed(torques);
    }
    if (!controls.object_stress.empty()) json["object_stress"] = json_of(controls.object_stress);
    if (controls.friction) json["friction"] = json_of(*controls.friction);
    if (controls.inertia)
        json["inertia"] = Json{{"start", json_of(controls.inertia->start())}, {"dt", controls.inertia->dt()}};
    if (controls.inertia && controls.inertia->scheme() != Scheme::even)
        json["inertia"]["scheme"] = static_cast<int>(controls.inertia->scheme());
    return json;
}

Json json_of(const StepPair& pair) {
    return {{"step", packed(pair.step)}, {"change", packed(pair.change)}, {"rho", pair.rho}, {"scale", pair.scale}};
}

Json json_of(const NewtonRates& r) {
    return {{"share", r.share_},
            {"cautious", r.cautious_},
            {"share_wanted", r.share_wanted_},
            {"usable", r.usable_},
            {"hasty", r.hasty_},
            {"reused", r.reused_},
            {"left", r.left_},
            {"left_at_first", r.left_at_first_},
            {"left_by_last", r.left_by_last_},
            {"left_by_new", r.left_by_new_},
            {"uses", r.uses_},
            {"age", r.age_},
            {"tried_later", r.tried_later_},
            {"two_levels", r.two_levels_}};
}

Json json_of(const TangentInverse::Memory& m) {
    return {{"in_double", m.in_double}, {"untried", m.untried},   {"known_error", m.known_error},
            {"trusted", m.trusted},     {"refusals", m.refusals}, {"usual_gain", m.usual_gain}};
}

Json json_of(const SolverMemory::Tangent& tangent) {
    return {{"state", json_of(tangent.state)}, {"controls", json_of(tangent.controls)}};
}

Json json_of(const SolverMemory& memory) {
    Json json{{"rates", json_of(memory.rates)},
              {"inverse", json_of(memory.inverse)},
              {"forgets_touching", memory.forgets_touching},
              {"pairs", Json::array()}};
    for (const auto& pair : memory.pairs) json["pairs"].push_back(json_of(*pair));
    if (memory.learnt) json["learnt"] = json_of(*memory.learnt);
    if (memory.followed) json["followed"] = packed(*memory.followed);
    if (memory.tangent) json["tangent"] = json_of(*memory.tangent);
    if (memory.base.tangent) {
        json["base"] = {{"share", memory.base.share}};
        if (memory.base.tangent != memory.tangent) json["base"]["tangent"] = json_of(*memory.base.tangent);
    }
    if (memory.touching) {
        json["touching"] = Json::array();
        for (const auto& clique : *memory.touching) json["touching"].push_back(packed(std::span<const int>(clique)));
    }
    return json;
}

}  // namespace

std::string state_bytes(const Model& model, const RobotState& robot) {
    Json json{{"format", state_format_name},
              {"version", state_version},
              {"mesh", mesh_digest(model.mesh())},
              {"parts", parts_digest(model.description())},
              {"along", robot.now.along},
              {"state", json_of(robot.now.state)},
              {"inputs", json_of(robot.inputs)},
              {"drives", json_of(robot.drives)},
              {"controls", json_of(robot.controls)},
              {"past", Json::array()}};
    for (const PastMoment& past : robot.past)
        json["past"].push_back({{"along", past.along}, {"state", json_of(*past.state)}});
    if (robot.before) json["before"] = json_of(*robot.before);
    if (robot.history.x.size() > 0) json["history"] = json_of(robot.history);
    if (robot.memory) json["memory"] = json_of(*robot.memory);
    return cbor::sealed(json);
}

}  // namespace pliant::sim
