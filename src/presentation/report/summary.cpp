#include "presentation/report/summary.hpp"

#include <nlohmann/json.hpp>
#include <numbers>

#include "base/core/json.hpp"
#include "presentation/report/units.hpp"

namespace pliant::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr double mm3_per_m3 = 1e9;

Json vector_json(const Vec3& v, double factor) {
    return Json::array({factor * v.x, factor * v.y, factor * v.z});
}

Json actuators_json(const sim::Step& step) {
    Json out;
    out["cables"] = Json::object();
    for (const auto& cable : step.cables) {
        out["cables"][cable.name] = {{"length_ratio", cable.length_ratio},
                                     {"length_mm", mm_per_m * cable.length_m},
                                     {"tension_N", cable.tension_N}};
    }
    out["chambers"] = Json::object();
    for (const auto& chamber : step.chambers) {
        out["chambers"][chamber.name] = {{"volume_ratio", chamber.volume_ratio},
                                         {"volume_mm3", mm3_per_m3 * chamber.volume_m3},
                                         {"pressure_kPa", 1e-3 * chamber.pressure_Pa}};
    }
    for (const auto& spring : step.springs)
        out["springs"][spring.name] = {{"length_mm", mm_per_m * spring.length_m}, {"force_N", spring.force_N}};
    return out;
}

Json step_json(const sim::Step& step, bool contact) {
    Json out = {{"index", step.index},           {"time", step.time},
                {"converged", step.converged},   {"reason", step.reason},
                {"iterations", step.iterations}, {"substeps", step.substeps},
                {"residual", step.residual},     {"wall_ms", 1e3 * step.wall_s},
                {"min_J", step.min_J},           {"solver", step.index == 0 ? "" : sim::name(step.solver)},
                {"energy_J", step.energy_J},     {"kinetic_energy_J", step.kinetic_energy_J}};
    if (step.refused > 0) out["refused"] = step.refused;
    out.update(actuators_json(step));
    out["supports"] = Json::object();
    for (const auto& support : step.supports) {
        out["supports"][support.name] = {{"force_N", vector_json(support.force_N, 1)}};
    }
    if (contact) {
        out["contacts"] = Json::object();
        for (const auto& obstacle : step.contacts)
            out["contacts"][obstacle.name] = {{"force_N", vector_json(obstacle.force_N, 1)}};
        out["self_contact_N"] = step.self_contact_N;
        out["smallest_distance_mm"] = mm_per_m * step.smallest_distance_m;
    }
    for (const auto& object : step.objects)
        out["objects"][object.name] = {{"position_mm", vector_json(object.position_m, mm_per_m)},
                                       {"rotation", object.rotation},
                                       {"force_N", vector_json(object.force_N, 1)}};
    for (const auto& joint : step.joints) {
        Json& entry = out["joints"][joint.name];
        entry = {{"force_N", vector_json(joint.force_N, 1)}, {"torque_Nm", vector_json(joint.torque_Nm, 1)}};
        if (joint.turns) entry["angle_deg"] = 180 / std::numbers::pi * joint.coordinate;
        if (joint.slides) entry["position_mm"] = mm_per_m * joint.coordinate;
        if (joint.turns) entry["effort_Nm"] = joint.effort;
        if (joint.slides) entry["effort_N"] = joint.effort;
    }
    for (const auto& sensor : step.sensors) {
        for (const sim::Reading& r : sensor.readings) {
            const sim::Shown as = sim::shown(r.quantity);
            out["sensors"][sensor.name][r.name + std::string(as.suffix)] = as.factor * r.value;
        }
    }
    if (step.crossing_m) out["crossing_mm"] = vector_json(*step.crossing_m, mm_per_m);
    out["markers"] = Json::object();
    for (const auto& marker : step.markers) out["markers"][marker.name] = vector_json(marker.position_m, mm_per_m);
    return out;
}

Json timing_json(const Simulation& s) {
    const sim::Trajectory& result = s.result;
    const auto steps = static_cast<double>(result.steps.size()) - 1;
    return {{"mesh_ms", 1e3 * s.timing.mesh_s},
            {"setup_ms", 1e3 * (s.timing.model_s + result.setup_s)},
            {"solve_ms", 1e3 * result.solve_s},
            {"files_ms", 1e3 * s.timing.files_s},
            {"pictures_ms", 1e3 * s.timing.pictures_s},
            {"frames_per_second", result.solve_s > 0 ? steps / result.solve_s : 0.0}};
}

}  // namespace

std::string summary_json(const Simulation& s, int indent) {
    Json out = {{"pliant", PLIANT_VERSION},      {"robot", s.robot},
                {"nodes", s.mesh.points.size()}, {"tets", s.mesh.tet_count()},
                {"order", s.mesh.order},         {"solver", s.result.solver},
                {"tolerance", s.tolerance},      {"converged", s.result.converged},
                {"message", s.result.message},   {"warnings", s.result.warnings}};
    const bool contact = has_contact(s.result);
    out["rest"] = step_json(s.result.steps.front(), contact);
    out["steps"] = Json::array();
    for (std::size_t i = 1; i < s.result.steps.size(); ++i)
        out["steps"].push_back(step_json(s.result.steps[i], contact));
    for (const Deviation& d : deviations(s.measured, s.result)) {
        out[s.measured_as][d.marker] = {{"points", d.points},
                                        {"mean_mm", mm_per_m * d.mean_m},
                                        {"largest_mm", mm_per_m * d.largest_m},
                                        {"way_mm", mm_per_m * d.way_m}};
    }
    out["timing"] = timing_json(s);
    out["peak_memory_MB"] = s.peak_memory_MB;
    return json_text(out, indent) + "\n";
}

}  // namespace pliant::report
