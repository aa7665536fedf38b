#include "printing/machine/printer.hpp"

#include <algorithm>
#include <cstdlib>

namespace pliant::machine {
namespace {

constexpr int full_turn = 360000;  // thousandths of a degree

const CleaningPair* find_pair(const Printer& printer, int from_vat, int to_vat) {
    if (printer.cleaning.pairs.empty()) return nullptr;
    const std::string& from = printer.vats[static_cast<std::size_t>(from_vat)].resin;
    const std::string& to = printer.vats[static_cast<std::size_t>(to_vat)].resin;
    const auto& pairs = printer.cleaning.pairs;
    const auto found =
        std::find_if(pairs.begin(), pairs.end(), [&](const CleaningPair& p) { return p.from == from && p.to == to; });
    return found == pairs.end() ? nullptr : &*found;
}

}  // namespace

std::string_view axis_name(Axis axis, Store store) {
    constexpr std::string_view names[axis_count] = {"carriage", "platform", "tower", "table"};
    constexpr std::string_view of_wall[axis_count] = {"carriage", "platform", "lift", "rail"};
    return (store == Store::wall ? of_wall : names)[static_cast<std::size_t>(axis)];
}

std::string_view method_name(CleaningMethod method) {
    constexpr std::string_view names[] = {"spray", "ultrasound", "bath"};
    return names[static_cast<std::size_t>(method)];
}

std::string_view signal_name(EmergencyLine::Signal signal) {
    constexpr std::string_view names[] = {"none", "controller", "dtr", "rts", "file"};
    return names[static_cast<std::size_t>(signal)];
}

int Printer::slot_count() const {
    const int stations = static_cast<int>(table.stations_um.size());
    switch (store()) {
        case Store::tower:
            return tower.slots * std::max(1, stations);
        case Store::wall:
            return wall.rows * wall.columns;
        case Store::table:
            return stations;
        case Store::none:
            break;
    }
    return 1;
}

int Printer::station_um(int slot) const {
    if (store() == Store::wall) return wall.bay_rail_um;
    if (table.stations_um.empty()) return 0;
    const int station = store() == Store::tower ? (slot - 1) / tower.slots : slot - 1;
    return table.stations_um[static_cast<std::size_t>(station)];
}

int Printer::nearest_um(int target_um, int from_um) const {
    const AxisSpec& spec = axis(Axis::table);
    if (!spec.rotary) return target_um;
    int best = target_um;
    bool found = false;
    const int first = target_um - (target_um - spec.min_um) / full_turn * full_turn;
    for (int um = first; um <= spec.max_um; um += full_turn) {
        if (um < spec.min_um || (found && std::abs(um - from_um) >= std::abs(best - from_um))) continue;
        best = um;
        found = true;
    }
    return best;
}

bool Printer::table_at(int table_um, int target_um) const {
    const int off = table_um - target_um;
    return axis(Axis::table).rotary ? off % full_turn == 0 : off == 0;
}

const Resin* Printer::find_resin(std::string_view resin) const {
    const auto found = std::find_if(resins.begin(), resins.end(), [&](const Resin& r) { return r.name == resin; });
    return found == resins.end() ? nullptr : &*found;
}

const Vat* Printer::vat_of_slot(int slot) const {
    const auto found = std::find_if(vats.begin(), vats.end(), [&](const Vat& v) { return v.slot == slot; });
    return found == vats.end() ? nullptr : &*found;
}

double Printer::filled_ml(const Vat& vat) const {
    return vat.resin.empty() && vat.fill_ml <= vat_shape.least_ml ? vat_shape.free_volume_ml : vat.fill_ml;
}

double Printer::cleaning_s(int from_vat, int to_vat) const {
    const CleaningPair* pair = find_pair(*this, from_vat, to_vat);
    return pair != nullptr ? pair->spray_s : cleaning.spray_s;
}

double Printer::penalty_s(int from_vat, int to_vat) const {
    const CleaningPair* pair = find_pair(*this, from_vat, to_vat);
    return pair != nullptr ? pair->penalty_s : 0;
}

}  // namespace pliant::machine
