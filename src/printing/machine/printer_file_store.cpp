// The tables of a printer file about the store and how vats move: [carriage], [tower], [wall], [table], [hooks]; and
// checks across them.
#include <string>
#include <tuple>
#include <vector>

#include "printing/machine/gcode.hpp"
#include "printing/machine/printer_reading.hpp"

namespace pliant::machine::reading {
namespace {

Carriage read_carriage(Reader r) {
    Carriage c;
    c.print_um = length_um(r, "print_position", static_cast<int>(-longest_um));
    c.tower_um = length_um(r, "tower_position", static_cast<int>(-longest_um));
    c.back_off_um = length_um(r, "back_off", 1);
    c.shear_um = length_um(r, "shear");
    c.shear_speed_mm_s = speed(r, "shear_speed");
    c.along_y = r.choice("along", {"x", "y"}, "x") == "y";
    r.finish();
    return c;
}

Tower read_tower(Reader r) {
    Tower t;
    t.slots = r.whole("slots", 1, 1000);
    t.first_slot_um = length_um(r, "first_slot", static_cast<int>(-longest_um));
    t.pitch_um = length_um(r, "pitch", 1);
    t.clearance_um = length_um(r, "clearance");
    if (r.has("pitch") && t.pitch_um > longest_um / t.slots) r.problem("pitch", "makes a tower over 100 m");
    r.finish();
    return t;
}

/// The fork has two positions, in and out, so it has a switch and a duration.
void read_fork(Reader r, Wall& w) {
    w.fork_s = positive(r, "time", Dimension::time, 1);
    w.fork = read_switch(r);
    if (w.fork.on.empty())
        r.problem("on", "is missing: the command that puts the fork out, and \"off\" that pulls it back");
}

Wall read_wall(Reader r) {
    constexpr int any_um = static_cast<int>(-longest_um);
    Wall w;
    w.rows = r.whole("rows", 1, 100);
    w.columns = r.whole("columns", 1, 100);
    w.first_row_um = length_um(r, "first_row", any_um);
    w.row_pitch_um = length_um(r, "row_pitch", 1);
    w.first_column_um = length_um(r, "first_column", any_um);
    w.column_pitch_um = length_um(r, "column_pitch", 1);
    const auto bay = r.quantities("bay", Dimension::length, 2);
    if (bay.size() == 2) {
        w.bay_rail_um = checked_um(r, "bay", bay[0]);
        w.bay_lift_um = checked_um(r, "bay", bay[1]);
    }
    w.lift_off_um = length_um(r, "lift_off", 1);
    w.lift_off_mm_s = speed(r, "lift_off_speed");
    w.clearance_um = length_um(r, "clearance");
    for (const auto& [key, pitch_um, count] :
         {std::tuple{"row_pitch", w.row_pitch_um, w.rows}, {"column_pitch", w.column_pitch_um, w.columns}}) {
        if (r.has(key) && pitch_um > longest_um / count) r.problem(key, "makes a wall over 100 m");
    }
    read_fork(r.table("fork"), w);
    r.finish();
    return w;
}

/// Commands and times of the electromagnet; it has no hooks, so no stroke.
Magnet read_magnet(Reader& r) {
    Magnet m;
    m.coil = {r.text("on"), r.text("off")};
    m.engage_s = positive(r, "engage", Dimension::time, 1);
    m.release_s = positive(r, "release", Dimension::time, 1);
    if (!m.coil.on.empty() && !m.coil.off.empty()) check_switch_commands(r, m.coil);
    if (r.has("force") != r.has("vat_mass"))
        r.problem("force", "and vat_mass go together: what the magnet holds, and the mass of an empty vat");
    if (r.has("force")) {
        m.force_N = positive(r, "force", Dimension::force, 1);
        m.vat_kg = positive(r, "vat_mass", Dimension::mass, 1);
    }
    m.friction = not_negative_number(r, "friction", m.friction);
    if (r.has("resin_density")) m.resin_kg_m3 = positive(r, "resin_density", Dimension::density, 1);
    for (const char* key : {"travel", "speed"}) {
        if (r.raw(key) != nullptr)
            r.problem(key, "belongs to hooks: a magnet needs no stroke (kind = \"electromagnet\")");
    }
    return m;
}

Hooks read_hooks(Reader r) {
    Hooks hooks;
    (void)r.choice("kind", {"hooks", "electromagnet"}, "hooks");
    // The other keys of any other kind are those of a magnet.
    if (r.text("kind", "hooks") != "hooks") {
        hooks.magnet = read_magnet(r);
    } else {
        hooks.travel_um = length_um(r, "travel", 1);
        hooks.speed_mm_s = speed(r, "speed");
        for (const char* key : {"on", "off", "engage", "release", "force", "vat_mass", "friction", "resin_density"}) {
            if (r.raw(key) != nullptr) r.problem(key, "needs kind = \"electromagnet\"");
        }
    }
    r.finish();
    return hooks;
}

/// Stations are a list of any length; Reader needs the length in advance.
std::vector<int> read_stations(Reader& r, bool rotary) {
    std::vector<int> stations;
    const config::Value* raw = r.raw("stations");
    const auto* list = raw != nullptr ? std::get_if<config::Array>(&raw->data) : nullptr;
    constexpr std::size_t most = 1000;
    if (list == nullptr || list->empty() || list->size() > most) {
        r.problem("stations", "must be a list of 1 to 1000 positions such as [\"0 mm\", \"180 mm\"]");
        return stations;
    }
    for (const double place : r.quantities("stations", place_dimension(rotary), list->size())) {
        stations.push_back(place_um(r, "stations", place, rotary));
    }
    return stations;
}

Table read_table(Reader r, bool rotary, bool has_tower) {
    Table t;
    t.stations_um = read_stations(r, rotary);
    if (!has_tower) {
        t.cleaning_um = place_um(r, "cleaning", r.quantity("cleaning", place_dimension(rotary)), rotary);
        t.bath_gap_um = length_um(r, "bath_gap", 1);
    }
    r.finish();
    return t;
}

/// Checks that stations are within the travel of their axis.
class Within {
public:
    Within(Reader& root, const Printer& p) : root_(&root), p_(&p) {}

    void operator()(Axis axis, int um, std::string_view what) {
        const AxisSpec& a = p_->axis(axis);
        if (um >= a.min_um && um <= a.max_um) return;
        root_->problem(fmt::format("axis.{}.travel", axis_name(axis, p_->store())),
                       fmt::format("{} at {:.3f} mm is outside", what, um / 1000.0));
    }

private:
    Reader* root_;
    const Printer* p_;
};

void check_wall_stations(Within& within, const Printer& p) {
    const Wall& w = p.wall;
    within(Axis::table, w.bay_rail_um, "the bay");
    within(Axis::table, p.column_um(1), "the first column");
    within(Axis::table, p.column_um(w.columns), "the last column");
    within(Axis::tower, w.bay_lift_um, "the bay");
    within(Axis::tower, w.bay_lift_um - p.hooks.travel_um, "the bay, lowered,");
    within(Axis::tower, p.row_um(1) - w.lift_off_um, "the first row, lowered,");
    within(Axis::tower, p.row_um(p.slot_count()), "the last row");
}

void check_stations(Reader& root, const Printer& p) {
    Within within(root, p);
    for (const int station_um : p.table.stations_um) within(Axis::table, station_um, "a station");
    if (p.store() == Store::table) within(Axis::table, p.table.cleaning_um, "the cleaning station");
    within(Axis::platform, 0, "the floor of the vat");
    const int highest_um = p.axis(Axis::platform).max_um;
    const int most_lift_um = highest_um - p.platform.build_height_um;
    if (most_lift_um > 0 && p.platform.lift_um > most_lift_um)
        root.problem("platform.lift",
                     fmt::format("must be at most {:.3f} mm, so that a part as tall as build_height "
                                 "({:.3f} mm) is lifted within the platform's travel, to {:.3f} mm",
                                 most_lift_um / 1000.0, p.platform.build_height_um / 1000.0, highest_um / 1000.0));
    within(Axis::platform, p.clear_um(p.platform.build_height_um) + p.cleaning.stroke_z_um,
           "the tallest part, lifted clear of the vat for cleaning,");
    if (!p.has_carriage()) return;
    within(Axis::carriage, p.carriage.print_um, "the print position");
    within(Axis::carriage, p.carriage.print_um + p.carriage.shear_um, "the shear stroke");
    within(Axis::carriage, p.carriage.tower_um, "the tower position");
    if (p.store() == Store::wall) return check_wall_stations(within, p);
    within(Axis::tower, p.level_um(1) - p.hooks.travel_um, "slot 1, lowered,");
    within(Axis::tower, p.level_um(p.tower.slots), "the last slot");
}

void check_carriage_way(Reader& root, const Printer& p) {
    const Carriage& c = p.carriage;
    if (c.print_um + c.shear_um + p.cleaning.stroke_x_um + c.back_off_um >= c.tower_um) {
        root.problem("carriage.tower_position", "leaves no room for shear, back_off and the cleaning stroke");
    }
    if (p.axis(Axis::carriage).home_um() > c.tower_um - c.back_off_um) {
        root.problem("axis.carriage.home", "ends at the tower, which then could not be homed");
    }
    if (p.store() == Store::tower && p.hooks.travel_um >= p.tower.clearance_um) {
        root.problem("hooks.travel", "must be less than the tower's clearance");
    }
}

/// Checks that `count` vats fit above each other, with the free height between them.
void check_pitch(Reader& root, const Printer& p, const char* key, int count, int pitch_um, int clearance_um) {
    const int least_um = p.vat_shape.wall_um + clearance_um;
    if (count > 1 && pitch_um < least_um)
        root.problem(
            key, fmt::format("must be at least the vat's wall and the clearance above it, {:g} mm", least_um / 1000.0));
}

/// Checks that vats fit beside and above each other, with room to lift them off their places.
void check_wall(Reader& root, const Printer& p) {
    const Wall& w = p.wall;
    const int wide_um = p.carriage.along_y ? p.platform.width_um : p.platform.depth_um;
    if (w.columns > 1 && w.column_pitch_um < wide_um) {
        root.problem("wall.column_pitch", fmt::format("is less than the platform is wide there, {:g} "
                                                      "mm: the vats would not fit beside each other",
                                                      wide_um / 1000.0));
    }
    if (w.lift_off_um >= w.clearance_um) root.problem("wall.lift_off", "must be less than the wall's clearance");
    check_pitch(root, p, "wall.row_pitch", w.rows, w.row_pitch_um, w.clearance_um);
}

void check_geometry(Reader& root, const Printer& p) {
    if (p.has_carriage()) check_carriage_way(root, p);
    if (p.store() == Store::wall) check_wall(root, p);
    if (p.store() == Store::tower)
        check_pitch(root, p, "tower.pitch", p.tower.slots, p.tower.pitch_um, p.tower.clearance_um);
    if (p.axis(Axis::platform).home_um() < p.clear_um(0)) {
        root.problem("axis.platform.home", "must end clear of the vat (home = \"max\")");
    }
    const auto& stations = p.table.stations_um;
    for (std::size_t i = 0; i < stations.size(); ++i) {
        const bool on_cleaning = p.store() == Store::table && p.table_at(stations[i], p.table.cleaning_um);
        if (on_cleaning) root.problem("table.stations", fmt::format("station {} is the cleaning station", i + 1));
        for (std::size_t k = 0; k < i; ++k) {
            if (p.table_at(stations[i], stations[k])) {
                root.problem("table.stations", fmt::format("stations {} and {} are the same place", k + 1, i + 1));
            }
        }
    }
}

}  // namespace

StoreTables store_tables(Reader& root) {
    StoreTables has;
    has.wall = root.has("wall");
    has.tower = root.has("tower") || (!has.wall && (root.has("carriage") || root.has("hooks")));
    has.table = root.has("table");
    if (has.wall && (has.tower || has.table))
        root.problem("wall", "is a store of its own: [tower] and [table] do not go with it");
    return has;
}

void read_store(Reader& root, Printer& p, const StoreTables& has) {
    if (has.carriage()) {
        p.carriage = read_carriage(root.table("carriage"));
        p.hooks = read_hooks(root.table("hooks"));
    }
    if (has.tower) p.tower = read_tower(root.table("tower"));
    if (has.wall) p.wall = read_wall(root.table("wall"));
    if (has.table) p.table = read_table(root.table("table"), p.axis(Axis::table).rotary, has.tower);
    if (p.slot_count() > 1000)
        root.problem(has.wall ? "wall.rows" : "tower.slots", "makes more than 1000 places for vats");
}

/// Twice the force needed to pull the fullest vat along its rails.
void check_magnet(Reader& root, const Printer& p) {
    const Magnet& m = p.hooks.magnet;
    if (!m.present() || m.force_N <= 0) return;
    double most_ml = 0;
    for (const Vat& vat : p.vats) most_ml = std::max(most_ml, vat.fill_ml);
    const double kg = m.vat_kg + most_ml * 1e-6 * m.resin_kg_m3;
    const double pull_N = kg * (m.friction * 9.81 + p.axis(Axis::carriage).acceleration_mm_s2 / 1000);
    if (m.force_N >= 2 * pull_N) return;
    root.problem("hooks.force", fmt::format("{:g} N hold too little: to pull the fullest vat, "
                                            "{:.2f} kg, takes {:.1f} N, and a magnet needs twice that",
                                            m.force_N, kg, pull_N));
}

void check_store(Reader& root, const Printer& p) {
    check_stations(root, p);
    check_geometry(root, p);
}

}  // namespace pliant::machine::reading
