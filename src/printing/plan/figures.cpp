#include "printing/plan/figures.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "printing/machine/cleaning_data.hpp"
#include "printing/machine/motion.hpp"
#include "printing/plan/swap.hpp"

namespace pliant::plan {
namespace {

using machine::Axis;
using machine::Printer;
using machine::Store;

/// The steps are separated by the start and end of the pump.
SwapSteps swap_steps(const Printer& p, int from_slot, int to_slot) {
    SwapSteps steps;
    Sequence s = standing_at(p, from_slot);
    std::vector<Stretch> stretches;
    s.record(&stretches);
    swap_vat(s, from_slot, to_slot);
    steps.total_s = s.seconds().total;
    steps.clean_s = s.seconds().clean;
    for (const Stretch& stretch : stretches) {
        if (stretch.device == Device::pump) steps.push_s = stretch.begin_s;
    }
    steps.pull_s = steps.total_s - steps.push_s - steps.clean_s;
    if (p.hooks.magnet.present())
        steps.hooks_s = p.hooks.magnet.release_s;
    else if (p.has_carriage())
        steps.hooks_s = machine::move_seconds(p, {}, {{0, 0, p.hooks.travel_um}}, p.hooks.speed_mm_s);
    return steps;
}

void measure_pairs(const Printer& p, double& mean_s, double& longest_s) {
    double sum = 0;
    int pairs = 0;
    for (const machine::Vat& from : p.vats) {
        for (const machine::Vat& to : p.vats) {
            if (from.slot == to.slot) continue;
            const double seconds = swap_seconds(p, from.slot, to.slot).total;
            sum += seconds;
            longest_s = std::max(longest_s, seconds);
            ++pairs;
        }
    }
    if (pairs > 0) mean_s = sum / pairs;
}

double long_side_mm(const Printer& p) {
    return std::max(p.platform.width_um, p.platform.depth_um) / 1000.0;
}

double short_side_mm(const Printer& p) {
    return std::min(p.platform.width_um, p.platform.depth_um) / 1000.0;
}

/// Vats of a wall, with one side of the bed along the wall; the retriever in front takes as much room as they do.
void measure_wall(const Printer& p, PrinterFigures& f) {
    const machine::Wall& w = p.wall;
    const double wide_mm = (p.carriage.along_y ? p.platform.width_um : p.platform.depth_um) / 1000.0;
    const double vat_mm = (w.row_pitch_um - w.clearance_um) / 1000.0;
    f.store_mm = (w.columns - 1) * w.column_pitch_um / 1000.0 + wide_mm;
    const double high_mm = (w.rows - 1) * w.row_pitch_um / 1000.0 + vat_mm;
    f.packing = w.rows * vat_mm * w.columns * wide_mm / (2 * high_mm * f.store_mm);
}

void measure_store(const Printer& p, PrinterFigures& f) {
    const int vats = static_cast<int>(p.vats.size());
    if (p.store() == Store::wall) return measure_wall(p, f);
    if (p.store() == Store::tower) {
        const int in_tower = std::min(p.tower.slots, vats);
        f.packing = tower_packing(p, in_tower);
        f.store_mm = tower_height_mm(p, p.tower.slots);
    } else if (p.store() == Store::table && p.axis(Axis::table).rotary) {
        f.packing = ring_packing(long_side_mm(p), short_side_mm(p), vats);
        f.store_mm = ring_diameter_mm(long_side_mm(p), short_side_mm(p), vats);
    } else if (p.store() == Store::table) {
        const auto [first, last] = std::minmax_element(p.table.stations_um.begin(), p.table.stations_um.end());
        f.store_mm = (*last - *first) / 1000.0 + short_side_mm(p);
        f.packing = vats * short_side_mm(p) / f.store_mm;
    }
}

void fit_vats(Printer& p, int vats) {
    machine::Vat vat = p.vats.front();
    p.vats.clear();
    for (vat.slot = 1; vat.slot <= vats; ++vat.slot) p.vats.push_back(vat);
}

/// Stations evenly spaced on the circle, including the cleaning station; the rim speed is constant, so a wider table
/// turns more slowly.
void widen_turntable(Printer& p, int vats) {
    const double before = ring_diameter_mm(long_side_mm(p), short_side_mm(p), static_cast<int>(p.vats.size()) + 1);
    const double after = ring_diameter_mm(long_side_mm(p), short_side_mm(p), vats + 1);
    machine::AxisSpec& axis = p.axes[static_cast<std::size_t>(Axis::table)];
    axis.speed_mm_s *= before / after;
    axis.acceleration_mm_s2 *= before / after;
    axis.min_um = -180000;
    axis.max_um = 360000;
    p.table.stations_um.clear();
    p.table.cleaning_um = 0;
    for (int v = 1; v <= vats; ++v) p.table.stations_um.push_back(static_cast<int>(360000LL * v / (vats + 1)));
}

}  // namespace

double tower_height_mm(const Printer& printer, int vats) {
    return (static_cast<double>(vats) * printer.tower.pitch_um - printer.tower.clearance_um) / 1000;
}

double tower_packing(const Printer& printer, int vats) {
    return vats * (printer.tower.pitch_um - printer.tower.clearance_um) / 1000.0 / tower_height_mm(printer, vats);
}

double ring_diameter_mm(double long_mm, double short_mm, int vats) {
    // Neighbouring short sides touch at their corners and leave a polygon free in the middle.
    const double inner = vats > 2 ? short_mm / 2 / std::tan(std::numbers::pi / vats) : 0;
    return 2 * std::hypot(inner + long_mm, short_mm / 2);
}

double ring_packing(double long_mm, double short_mm, int vats) {
    const double diameter = ring_diameter_mm(long_mm, short_mm, vats);
    return vats * long_mm * short_mm / (std::numbers::pi * diameter * diameter / 4);
}

PrinterFigures figures(const Printer& printer) {
    PrinterFigures f;
    f.name = printer.name;
    f.area_mm2 = printer.platform.width_um / 1000.0 * printer.platform.depth_um / 1000.0;
    f.places = printer.slot_count();
    measure_store(printer, f);
    if (printer.vats.size() < 2) return f;
    f.swap = swap_steps(printer, printer.vats[0].slot, printer.vats[1].slot);
    measure_pairs(printer, f.mean_swap_s, f.longest_swap_s);
    f.removed = machine::cleaning_law(printer.cleaning.method).removed(printer.cleaning.spray_s);
    return f;
}

Printer with_vats(const Printer& printer, int vats) {
    Printer p = printer;
    if (p.store() == Store::tower) {
        p.tower.slots = vats;
        p.axes[static_cast<std::size_t>(Axis::tower)].max_um = p.level_um(vats);
    } else if (p.store() == Store::wall) {
        p.wall.columns = (vats + p.wall.rows - 1) / p.wall.rows;
        int& end_um = p.axes[static_cast<std::size_t>(Axis::table)].max_um;
        end_um = std::max(end_um, p.column_um(p.wall.columns));
    } else if (p.store() == Store::table && p.axis(Axis::table).rotary) {
        widen_turntable(p, vats);
    } else if (p.store() == Store::table) {
        const int first = p.table.stations_um.front();
        const int pitch = p.table.stations_um.size() > 1 ? p.table.stations_um[1] - first : first - p.table.cleaning_um;
        p.table.stations_um.clear();
        for (int v = 0; v < vats; ++v) p.table.stations_um.push_back(first + v * pitch);
        p.axes[static_cast<std::size_t>(Axis::table)].max_um = p.table.stations_um.back();
    }
    fit_vats(p, vats);
    return p;
}

Printer with_bed(const Printer& printer, double bed, double motors) {
    Printer p = printer;
    const auto scaled = [&](int um) { return static_cast<int>(std::lround(um * bed)); };
    for (const Axis axis : {Axis::carriage, Axis::tower, Axis::table})
        p.axes[static_cast<std::size_t>(axis)].speed_mm_s *= motors;
    if (p.has_carriage()) {
        const int longer_um =
            scaled(p.carriage.tower_um - p.carriage.print_um) - (p.carriage.tower_um - p.carriage.print_um);
        p.carriage.tower_um += longer_um;
        p.axes[static_cast<std::size_t>(Axis::carriage)].max_um += longer_um;
        (p.carriage.along_y ? p.platform.depth_um : p.platform.width_um) =
            scaled(p.carriage.along_y ? p.platform.depth_um : p.platform.width_um);
    } else if (p.store() == Store::table && !p.axis(Axis::table).rotary) {
        for (int& station_um : p.table.stations_um) station_um = scaled(station_um);
        p.table.cleaning_um = scaled(p.table.cleaning_um);
        p.axes[static_cast<std::size_t>(Axis::table)].min_um = scaled(p.axis(Axis::table).min_um);
        p.axes[static_cast<std::size_t>(Axis::table)].max_um = scaled(p.axis(Axis::table).max_um);
        p.platform.width_um = scaled(p.platform.width_um);
    }
    return p;
}

std::vector<SwapTimes> swap_over_vats(const Printer& printer, const std::vector<int>& vats) {
    std::vector<SwapTimes> times;
    for (const int n : vats) {
        const Printer p = with_vats(printer, n);
        SwapTimes t{n, swap_seconds(p, 1, 2).total, 0};
        double longest = 0;
        measure_pairs(p, t.mean_s, longest);
        times.push_back(t);
    }
    return times;
}

}  // namespace pliant::plan
