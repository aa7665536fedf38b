// The tables of a printer file about cleaning: [cleaning], [solution], [[sprinkler]].
#include "printing/machine/cleaning_data.hpp"
#include "printing/machine/printer_reading.hpp"

namespace pliant::machine::reading {
namespace {

CleaningMethod read_method(Reader& r) {
    const std::string method = r.choice("method", {"spray", "ultrasound", "bath"}, "spray");
    if (method == "bath") return CleaningMethod::bath;
    return method == "spray" ? CleaningMethod::spray : CleaningMethod::ultrasound;
}

CleaningPair read_pair(Reader& r, double spray_s) {
    CleaningPair pair{r.text("from"), r.text("to"), r.quantity("duration", Dimension::time, spray_s),
                      not_negative(r, "penalty", Dimension::time)};
    if (pair.spray_s < 0) r.problem("duration", "must not be negative");
    r.finish();
    return pair;
}

/// The default for what the brush takes off: the thesis' measurement for wiping with a cloth.
double cloth_share() {
    for (const CleaningTest& test : cleaning_tests()) {
        if (test.method == "cloth") return test.mean();
    }
    return 0;
}

/// The brush is in the vats of a tower. On a table the part would pass over the brushes of other resins.
void read_brush(Reader& r, Store store, int clearance_um, Cleaning& c) {
    c.brush = r.boolean("brush", false);
    if (c.brush && store != Store::tower && store != Store::wall)
        r.problem("brush", "needs a [tower] or a [wall]: on a table the brushes of other vats would wipe the part too");
    c.brush_um = r.has("brush_height") ? length_um(r, "brush_height") : clearance_um / 2;
    if (c.brush_um > clearance_um)
        r.problem("brush_height", fmt::format("is above platform.clearance, {:g} mm: there the part is out of reach",
                                              clearance_um / 1000.0));
    c.brush_share = share(r, "brush_share", cloth_share());
}

/// The filter needs both of its keys.
void read_filter(Reader& r, Solution& s) {
    if (r.has("filter") != r.has("filter_share")) {
        r.problem("filter", "and filter_share go together: how much resin it holds, and which share it keeps");
    } else if (r.has("filter")) {
        s.filter_ml = positive(r, "filter", Dimension::volume, 1e6);
        s.filter_share = share(r, "filter_share", 0);
    }
}

Sprinkler read_sprinkler(Reader& r) {
    Sprinkler s;
    const auto place = r.quantities("position", Dimension::length, 3);
    for (std::size_t i = 0; i < place.size() && i < 3; ++i)
        s.place_mm[i] = checked_um(r, "position", place[i]) / 1000.0;
    const std::vector<double> aim = r.has("aim") ? r.numbers("aim", 3) : std::vector<double>{0, 0, 1};
    const double length = aim.size() == 3 ? std::hypot(aim[0], aim[1], aim[2]) : 0;
    if (length > 0 && std::isfinite(length))
        s.aim = {aim[0] / length, aim[1] / length, aim[2] / length};
    else
        r.problem("aim", "must be a direction such as [0.5, 0, 1]");
    constexpr double widest_deg = 170;
    s.cone_rad = r.quantity("cone", Dimension::angle);
    if (r.has("cone") && !(s.cone_rad > 0 && s.cone_rad <= widest_deg / degrees))
        r.problem("cone", "must be above 0, at most 170 deg: the full angle");
    s.flow = r.number("flow", 1);
    if (!(s.flow > 0 && s.flow <= 1e6)) r.problem("flow", "must be above 0: its part beside those of the other heads");
    r.finish();
    return s;
}

}  // namespace

/// `spray` is the older name of `duration`.
Cleaning read_cleaning(Reader r, Store store, int clearance_um) {
    Cleaning c;
    if (store == Store::none) {
        r.finish();
        return c;
    }
    c.method = read_method(r);
    c.spray_s = wait_s(r, r.has("duration") ? "duration" : "spray");
    if (store == Store::tower || store == Store::wall) c.stroke_x_um = length_um(r, "stroke_x", 1);
    c.stroke_z_um = length_um(r, "stroke_z");
    c.speed_mm_s = speed(r, "speed");
    c.dry_s = wait_s(r, "dry");
    read_brush(r, store, clearance_um, c);
    if (r.has("film")) c.film_um = length_um(r, "film");
    c.solvent_ml_s = not_negative(r, "solvent", Dimension::volume, 1e6) / std::max(1e-9, c.spray_s > 0 ? c.spray_s : 1);
    c.most_contamination = r.number("most_contamination", 0.05);
    if (!(c.most_contamination > 0 && c.most_contamination <= 1)) {
        r.problem("most_contamination", "must be a share above 0, at most 1");
    }
    for (Reader& pair : r.tables("pair")) c.pairs.push_back(read_pair(pair, c.spray_s));
    r.finish();
    return c;
}

Solution read_solution(Reader r) {
    Solution s;
    s.volume_ml = positive(r, "volume", Dimension::volume, 1e6);
    s.fill_ml = r.quantity("fill", Dimension::volume, s.volume_ml / 1e6) * 1e6;
    if (s.fill_ml < 0 || s.fill_ml > s.volume_ml) r.problem("fill", "must be from 0 to volume");
    s.resin_share = share(r, "resin_share", 0);
    s.least_ml = not_negative(r, "least", Dimension::volume, 1e6);
    if (s.least_ml >= s.volume_ml && r.has("least")) r.problem("least", "must be less than volume");
    s.spray_loss = share(r, "spray_loss", 0.02);
    s.evaporation_ml_h = not_negative(r, "evaporation_per_hour", Dimension::volume, 1e6);
    s.spent_share = r.number("spent", 0.1);
    if (!(s.spent_share > 0 && s.spent_share <= 1)) r.problem("spent", "must be a share above 0, at most 1");
    read_filter(r, s);
    r.finish();
    return s;
}

void read_sprinklers(Reader& root, Printer& p) {
    constexpr std::size_t most = 64;
    if (!root.has("sprinkler")) return;
    for (Reader& r : root.tables("sprinkler")) p.sprinklers.push_back(read_sprinkler(r));
    if (p.store() == Store::none || p.cleaning.method != CleaningMethod::spray)
        root.problem("sprinkler", "belongs to a machine that cleans with method = \"spray\"");
    if (p.sprinklers.size() > most) root.problem("sprinkler", "there may be at most 64");
}

}  // namespace pliant::machine::reading
