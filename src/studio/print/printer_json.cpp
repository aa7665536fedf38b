#include "studio/print/printer_json.hpp"

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "printing/machine/switches.hpp"
#include "studio/print/millimetres.hpp"
#include "studio/print/printer_files.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;

/// Safety devices according to the machine's file: switches with their names on the wire, door, emergency line.
void add_safety(Json& json, const machine::Printer& p) {
    Json switches = Json::array();
    for (const machine::LimitSwitch& s : p.limit_switches)
        switches.push_back({{"axis", machine::axis_name(s.axis)},
                            {"end", s.at_max ? "max" : "min"},
                            {"name", machine::switch_names(p, s).front()}});
    json["switches"] = std::move(switches);
    json["door"] = p.door.present() ? Json(p.door.input) : Json(nullptr);
    const machine::EmergencyLine& line = p.emergency_line;
    json["emergency"] = {{"signal", machine::signal_name(line.signal)}, {"device", line.device}, {"pin", line.pin}};
}

}  // namespace

nlohmann::json projector_json(const machine::Projector& p) {
    return {{"width", p.width_px},
            {"height", p.height_px},
            {"pixel", p.pixel_um / 1e3},
            {"mirror_x", p.mirror_x},
            {"mirror_y", p.mirror_y},
            {"rotation", p.rotation_deg},
            {"offset_x", p.offset_x_um / 1e3},
            {"offset_y", p.offset_y_um / 1e3}};
}

nlohmann::json printer_json(const machine::Printer& p) {
    Json axes = Json::object(), vats = Json::array();
    for (const machine::Axis axis : machine::all_axes) {
        const machine::AxisSpec& spec = p.axis(axis);
        if (!spec.present()) continue;
        axes[std::string(machine::axis_name(axis))] = {
            {"min", mm(spec.min_um)}, {"max", mm(spec.max_um)}, {"speed", spec.speed_mm_s}, {"rotary", spec.rotary}};
    }
    for (const machine::Vat& vat : p.vats)
        vats.push_back({{"slot", vat.slot}, {"resin", vat.resin}, {"fill_ml", vat.fill_ml}});
    Json json = {
        {"name", p.name},
        {"store", store_name(p.store())},
        {"axes", axes},
        {"vats", vats},
        {"carriage", {{"print", mm(p.carriage.print_um)}, {"tower", mm(p.carriage.tower_um)}}},
        {"platform",
         {{"width", mm(p.platform.width_um)},
          {"depth", mm(p.platform.depth_um)},
          {"height", mm(p.platform.build_height_um)}}},
        {"tower", {{"slots", p.tower.slots}, {"first", mm(p.tower.first_slot_um)}, {"pitch", mm(p.tower.pitch_um)}}},
        {"wall", mm(p.vat_shape.wall_um)},
        {"projector", projector_json(p.projector)}};
    add_safety(json, p);
    return json;
}

}  // namespace pliant::studio
