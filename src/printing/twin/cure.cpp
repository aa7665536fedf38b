#include "printing/twin/cure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace pliant::twin {
namespace {

constexpr std::size_t most_faults = 1000;
constexpr double rounding_um = 0.01;

}  // namespace

double allowed_overcure_um(const machine::Resin& resin) {
    return resin.cure_depth_um + resin.bleed_compensation_um;
}

Cure::Cure(const machine::Printer& printer, Keep keep) : printer_(&printer), keep_(keep) {
    for (const machine::Vat& vat : printer.vats) {
        left_ml_.push_back(vat.fill_ml);
        const machine::Resin* resin = printer.find_resin(vat.resin);
        curves_.push_back(resin != nullptr ? working_curve(printer, *resin) : WorkingCurve{});
        allowed_um_.push_back(resin != nullptr ? allowed_overcure_um(*resin) : 0);
    }
    overcure_mm3_.resize(printer.vats.size());
    overcure_beyond_mm3_.resize(printer.vats.size());
}

void Cure::clear() {
    const std::vector<double> left_ml = left_ml_;
    *this = Cure(*printer_, keep_);
    left_ml_ = left_ml;
}

double Cure::pixel_mm2() const {
    return printer_->projector.pixel_um * printer_->projector.pixel_um / 1e6;
}

void Cure::fault(std::string text) {
    if (faults_.size() < most_faults) faults_.push_back(std::move(text));
}

/// Why the exposure cures nothing that is attached to the part; "": it does.
std::string Cure::why_not(int vat, double seconds, int z_um, double area_mm2) const {
    const machine::Vat& place = printer_->vats[static_cast<std::size_t>(vat)];
    const machine::Resin* resin = printer_->find_resin(place.resin);
    const double depth = curves_[static_cast<std::size_t>(vat)].depth_um(machine::irradiance_W_m2(*printer_) * seconds);
    if (resin == nullptr) return fmt::format("slot {} holds no resin", place.slot);
    if (z_um <= top_um_) return fmt::format("no gap is left at {} um", z_um);
    if (depth + rounding_um < z_um - top_um_) {
        return fmt::format("{:.3f} s of light cure {:.0f} um of {}, the gap at {} um is {} um", seconds, depth,
                           resin->name, z_um, z_um - top_um_);
    }
    if (left_ml_[static_cast<std::size_t>(vat)] < area_mm2 * (z_um - top_um_) / 1e6)
        return fmt::format("the vat of slot {} has run dry at {} um", place.slot, z_um);
    return "";
}

void Cure::open(int z_um) {
    if (open_ && open_->top_um == z_um) return;
    finish();
    open_ = OpenLayer{z_um, z_um - top_um_, {}};
    open_->lit.resize(printer_->vats.size());
    section_before_mm2_ = std::exchange(section_mm2_, 0);
}

/// The exposure that this one continues, if that has cured already.
Lit* Cure::lit_before(const Runs& light, int vat, int z_um) {
    if (!open_ || open_->top_um != z_um) return nullptr;
    std::vector<Lit>& all = open_->lit[static_cast<std::size_t>(vat)];
    const auto same = std::find_if(all.begin(), all.end(), [&](const Lit& lit) { return lit.light == light; });
    return same == all.end() ? nullptr : &*same;
}

void Cure::give_up_faint() {
    if (faint_) fault(std::move(faint_->why));
    faint_.reset();
}

void Cure::expose(const Runs& light, int vat, double seconds, int z_um) {
    if (open_ && open_->top_um != z_um) finish();
    const double dose = machine::irradiance_W_m2(*printer_) * seconds;
    if (Lit* before = lit_before(light, vat, z_um)) {
        before->seconds += seconds;
        ++before->pieces;
        return shine_through(light, vat, dose);
    }
    Lit lit{light, seconds, 1};
    if (faint_ && faint_->vat == vat && faint_->z_um == z_um && faint_->lit.light == light) {
        lit.seconds += faint_->lit.seconds;
        lit.pieces += faint_->lit.pieces;
        faint_.reset();
    }
    give_up_faint();
    const double area_mm2 = static_cast<double>(light_of(light)) / 255 * pixel_mm2();
    if (std::string why = why_not(vat, lit.seconds, z_um, area_mm2); !why.empty()) {
        faint_ = Faint{std::move(lit), vat, z_um, std::move(why)};
        return;
    }
    open(z_um);
    section_mm2_ += area_mm2;
    left_ml_[static_cast<std::size_t>(vat)] -= area_mm2 * open_->thickness_um / 1e6;
    shine_through(light, vat, machine::irradiance_W_m2(*printer_) * lit.seconds);
    open_->lit[static_cast<std::size_t>(vat)].push_back(std::move(lit));
}

/// Depth below the ceiling of a column to which resin has cured.
double Cure::overcure_um(const Column& column) const {
    return std::min<double>(curves_[static_cast<std::size_t>(column.vat)].depth_um(column.dose_J_m2), column.free_um);
}

/// In steps, so that a part that leans does not move its columns with every layer.
void Cure::Strip::reach(int from, int to) {
    constexpr int step = 64;
    const int end = begin + static_cast<int>(columns.size());
    if (columns.empty()) {
        begin = from / step * step;
        columns.resize(static_cast<std::size_t>((to + step - 1) / step * step - begin));
    } else if (from < begin || to > end) {
        const int first = std::min(from / step * step, begin);
        const int last = std::max((to + step - 1) / step * step, end);
        std::vector<Column> wider(static_cast<std::size_t>(last - first));
        std::copy(columns.begin(), columns.end(), wider.begin() + (begin - first));
        columns = std::move(wider);
        begin = first;
    }
}

/// Adds light to the ceiling of a column, that of pixel `at` of a row.
void Cure::add_dose(Column& column, int row, int at, double dose_J_m2) {
    const auto vat = static_cast<std::size_t>(column.vat);
    const double before = overcure_um(column);
    column.dose_J_m2 += static_cast<float>(dose_J_m2);
    const double after = overcure_um(column);
    overcure_mm3_[vat] += (after - before) / 1000 * pixel_mm2();
    const double allowed = allowed_um_[vat];
    if (after > allowed) overcure_beyond_mm3_[vat] += (after - std::max(before, allowed)) / 1000 * pixel_mm2();
    if (after <= deepest_overcure_um_) return;
    deepest_overcure_um_ = after;
    deepest_ = {row, at, column.bottom_um};
}

/// Passes light through the new layer and all solid above it, up to the ceiling of the column.
void Cure::shine_through(const Runs& light, int vat, double dose_J_m2) {
    strips_.resize(static_cast<std::size_t>(printer_->projector.height_px));
    const int top_um = open_->top_um;
    const int bottom_um = top_um - open_->thickness_um;
    const double penetration_um = curves_[static_cast<std::size_t>(vat)].penetration_um;
    const double reach_um = 8 * penetration_um;
    int known_way_um = -1;
    double known_dose = 0;
    for (std::size_t i = 0, row_end = 0; i < light.size(); ++i) {
        const Run& run = light[i];
        Strip& strip = strips_[static_cast<std::size_t>(run.row)];
        if (i == row_end) {
            while (row_end < light.size() && light[row_end].row == run.row) ++row_end;
            strip.reach(run.begin, light[row_end - 1].end);
        }
        Column* c = strip.columns.data() + (run.begin - strip.begin);
        for (int at = run.begin; at < run.end; ++at, ++c) {
            if (c->top_um < bottom_um)  // no solid directly above: a new ceiling
                *c = {bottom_um, top_um, bottom_um - c->top_um, 0, static_cast<std::int16_t>(vat)};
            c->top_um = top_um;
            const int way_um = top_um - c->bottom_um;
            if (c->free_um <= 0 || way_um > reach_um) continue;
            if (way_um != known_way_um) {
                known_way_um = way_um;
                known_dose = dose_J_m2 * std::exp(-way_um / penetration_um);
            }
            add_dose(*c, run.row, at, known_dose);
        }
    }
}

void Cure::count_double(const OpenLayer& layer) {
    if (open_lights() < 2) return;
    std::vector<Runs> all;
    for (const std::vector<Lit>& of_vat : layer.lit) {
        for (const Lit& lit : of_vat) all.push_back(lit.light);
    }
    for (const Run& run : sum_of(all, printer_->projector.width_px)) {
        if (run.value > 255) pixels_lit_twice_ += run.end - run.begin;
    }
}

CuredLayer Cure::closed(OpenLayer ended) const {
    CuredLayer layer{ended.top_um, ended.thickness_um, {}};
    for (std::size_t vat = 0; vat < ended.lit.size(); ++vat) {
        if (ended.lit[vat].empty()) continue;
        std::vector<Runs> lights;
        for (const Lit& lit : ended.lit[vat]) lights.push_back(lit.light);
        Runs sum = sum_of(lights, printer_->projector.width_px);
        layer.vats.push_back({static_cast<int>(vat), std::move(sum), std::move(ended.lit[vat])});
    }
    return layer;
}

std::optional<CuredLayer> Cure::open_layer() const {
    return open_ ? std::optional(closed(*open_)) : std::nullopt;
}

std::size_t Cure::open_lights() const {
    std::size_t lights = 0;
    for (std::size_t vat = 0; open_ && vat < open_->lit.size(); ++vat) lights += open_->lit[vat].size();
    return lights;
}

void Cure::finish() {
    give_up_faint();
    if (!open_) return;
    count_double(*open_);
    top_um_ = open_->top_um;
    if (keep_ == Keep::layers) layers_.push_back(closed(std::move(*open_)));
    open_.reset();
}

}  // namespace pliant::twin
