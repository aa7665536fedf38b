#include "studio/simulate/state_json.hpp"

#include <nlohmann/json.hpp>

#include "presentation/report/units.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;

Json three(const Vec3& v, double factor = 1) {
    return Json::array({factor * v.x, factor * v.y, factor * v.z});
}

}  // namespace

Json state_json(const sim::Step& step) {
    Json cables = Json::array(), chambers = Json::array(), markers = Json::array(), supports = Json::array(),
         contacts = Json::array(), sensors = Json::array();
    for (const auto& c : step.cables)
        cables.push_back(
            {{"ratio", c.length_ratio}, {"length_mm", report::mm_per_m * c.length_m}, {"tension_N", c.tension_N}});
    for (const auto& c : step.chambers)
        chambers.push_back(
            {{"ratio", c.volume_ratio}, {"volume_mm3", 1e9 * c.volume_m3}, {"pressure_kPa", 1e-3 * c.pressure_Pa}});
    for (const auto& m : step.markers) markers.push_back(three(m.position_m, report::mm_per_m));
    for (const auto& s : step.supports) supports.push_back(three(s.force_N));
    for (const auto& c : step.contacts) contacts.push_back(three(c.force_N));
    for (const auto& o : step.objects) contacts.push_back(three(o.force_N));
    for (const auto& sensor : step.sensors) {
        Json readings = Json::array();
        for (const sim::Reading& r : sensor.readings) readings.push_back(sim::shown(r.quantity).factor * r.value);
        sensors.push_back(std::move(readings));
    }
    return {{"time", step.time},
            {"residual", step.residual},
            {"min_J", step.min_J},
            {"energy_mJ", 1e3 * step.energy_J},
            {"cables", cables},
            {"chambers", chambers},
            {"markers", markers},
            {"supports", supports},
            {"contacts", contacts},
            {"sensors", sensors},
            {"self_contact_N", step.self_contact_N}};
}

}  // namespace pliant::studio
