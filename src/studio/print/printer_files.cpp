#include "studio/print/printer_files.hpp"

#include <mutex>
#include <nlohmann/json.hpp>

#include "base/core/files.hpp"
#include "base/core/toml_edit.hpp"
#include "printing/machine/board_report.hpp"
#include "printing/machine/built_in_printers.hpp"
#include "printing/machine/switches.hpp"
#include "printing/operate/job_file.hpp"
#include "studio/base/dumped.hpp"
#include "studio/print/millimetres.hpp"
#include "studio/print/printer_json.hpp"

namespace pliant::studio {
namespace {

using Json = nlohmann::json;

constexpr std::uintmax_t largest_file = 4 << 20;

Json axes_json(const machine::Printer& p) {
    Json axes = Json::array();
    for (const machine::Axis axis : machine::all_axes) {
        const machine::AxisSpec& spec = p.axis(axis);
        if (!spec.present()) continue;
        axes.push_back({{"name", machine::axis_name(axis, p.store())},
                        {"letter", std::string(1, spec.letter)},
                        {"min", mm(spec.min_um)},
                        {"max", mm(spec.max_um)},
                        {"speed", spec.speed_mm_s},
                        {"acceleration", spec.acceleration_mm_s2},
                        {"homing_speed", spec.homing_speed_mm_s},
                        {"home", spec.homes_by_hand  ? "hand"
                                 : spec.homes_to_max ? "max"
                                                     : "min"},
                        {"rotary", spec.rotary}});
    }
    return axes;
}

Json resins_json(const machine::Printer& p) {
    Json resins = Json::array();
    for (const machine::Resin& r : p.resins)
        resins.push_back({{"name", r.name},
                          {"exposure_s", r.exposure_s},
                          {"bottom_exposure_s", r.bottom_exposure_s},
                          {"bottom_layers", r.bottom_layers},
                          {"longest_exposure_s", p.limits.exposure_s}});
    return resins;
}

/// The text of a printer and the folder of its mask.
Result<std::pair<std::string, std::filesystem::path>> text_of(const ProjectFolder& folder, const std::string& name) {
    if (const EmbeddedFile* known = find_file(machine::built_in_printers(), name))
        return std::pair(std::string(known->text), std::filesystem::path(name + ".toml"));
    const Result<std::filesystem::path> path = folder.resolve(name);
    if (!path) return tl::unexpected(path.error());
    Result<std::string> text = read_file(*path, largest_file);
    if (!text) return tl::unexpected(text.error());
    if (!folder.check_texts(*text, *path)) return input_error("{}: names a file outside of the project folder", name);
    return std::pair(std::move(*text), *path);
}

Result<std::filesystem::path> own_file(const ProjectFolder& folder, const std::string& name) {
    if (find_file(machine::built_in_printers(), name) != nullptr)
        return input_error("{}: is built in; make a printer file of your own from it", name);
    Result<std::filesystem::path> path = folder.resolve(name);
    if (path && lower_extension(*path) != ".toml") return input_error("\"{}\": a printer file ends with .toml", name);
    return path;
}

}  // namespace

std::string_view store_name(machine::Store store) {
    switch (store) {
        case machine::Store::tower:
            return "tower";
        case machine::Store::wall:
            return "wall";
        case machine::Store::table:
            return "table";
        default:
            return "none";
    }
}

Result<prepare::PrinterFile> read_printer(const ProjectFolder& folder, const std::string& name) {
    auto text = text_of(folder, name);
    if (!text) return tl::unexpected(text.error());
    prepare::PrinterFile file;
    file.text = std::move(text->first);
    Result<machine::Printer> printer = machine::parse_printer(file.text, text->second.filename());
    if (!printer) return tl::unexpected(printer.error());
    file.printer = std::move(*printer);
    Result<std::optional<job::Image>> mask = operate::load_mask(file.printer.projector, text->second);
    if (!mask) return tl::unexpected(mask.error());
    file.mask = std::move(*mask);
    return file;
}

Status new_printer(const ProjectFolder& folder, const std::string& from, const std::string& name) {
    const std::lock_guard lock(folder.one_change_at_a_time());
    const auto path = own_file(folder, name);
    if (!path) return tl::unexpected(path.error());
    std::error_code ignored;
    if (std::filesystem::exists(*path, ignored)) return input_error("\"{}\" exists; choose another name", name);
    const auto text = text_of(folder, from);
    if (!text) return tl::unexpected(text.error());
    if (const auto printer = machine::parse_printer(text->first, from); !printer)
        return tl::unexpected(printer.error());
    return write_file(*path, text->first);
}

Status change_printer(const ProjectFolder& folder, const std::string& name, const PrinterChanges& changes) {
    const std::lock_guard lock(folder.one_change_at_a_time());
    const auto path = own_file(folder, name);
    if (!path) return tl::unexpected(path.error());
    const auto text = text_of(folder, name);
    if (!text) return tl::unexpected(text.error());
    std::string next = text->first;
    for (const auto& [key, value] : changes) {
        auto changed = config::with_value(next, key, value);
        if (!changed) return tl::unexpected(changed.error());
        next = std::move(*changed);
    }
    if (const auto printer = machine::parse_printer(next, path->filename()); !printer)
        return tl::unexpected(printer.error());
    if (!folder.check_texts(next, *path)) return input_error("{}: names a file outside of the project folder", name);
    return write_file(*path, next);
}

std::string printer_setup_json(const std::string& name, const machine::Printer& p, bool built_in) {
    Json vats = Json::array(), switches = Json::array();
    for (const machine::Vat& vat : p.vats)
        vats.push_back({{"slot", vat.slot}, {"resin", vat.resin}, {"fill_ml", vat.fill_ml}});
    for (const machine::LimitSwitch& s : p.limit_switches)
        switches.push_back({{"axis", machine::axis_name(s.axis, p.store())},
                            {"end", s.at_max ? "max" : "min"},
                            {"name", machine::switch_names(p, s).front()}});
    return dumped({{"name", name},
                   {"title", p.name},
                   {"built_in", built_in},
                   {"store", store_name(p.store())},
                   {"layer_um", p.layer_um},
                   {"baud_rate", p.controller.baud_rate},
                   {"dialect", p.controller.dialect == machine::Dialect::marlin ? "marlin" : "marlin-classic"},
                   {"axes", axes_json(p)},
                   {"slots", p.tower.slots},
                   {"vats", vats},
                   {"resins", resins_json(p)},
                   {"switches", switches},
                   {"platform",
                    {{"width_mm", mm(p.platform.width_um)},
                     {"depth_mm", mm(p.platform.depth_um)},
                     {"height_mm", mm(p.platform.build_height_um)}}},
                   {"projector", projector_json(p.projector)}});
}

std::string built_in_printers_json() {
    Json list = Json::array();
    for (const EmbeddedFile& file : machine::built_in_printers()) {
        const Result<machine::Printer> p = machine::parse_printer(file.text, std::string(file.name) + ".toml");
        if (!p) continue;
        list.push_back(
            {{"name", file.name},
             {"title", p->name},
             {"store", store_name(p->store())},
             {"vats", p->vats.size()},
             {"size_mm", {mm(p->platform.width_um), mm(p->platform.depth_um), mm(p->platform.build_height_um)}},
             {"pixel_um", p->projector.pixel_um},
             {"dialect", p->controller.dialect == machine::Dialect::marlin ? "marlin" : "marlin-classic"}});
    }
    return dumped(list);
}

std::string board_json(const std::string& answers, const machine::Printer& printer) {
    const machine::BoardReport board = machine::parse_board_report(answers);
    return dumped({{"firmware", board.name},
                   {"capabilities", board.capabilities},
                   {"switches", board.switches},
                   {"problems", machine::check_board(board, printer)}});
}

}  // namespace pliant::studio
