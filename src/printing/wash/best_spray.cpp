#include "printing/wash/best_spray.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "printing/machine/motion.hpp"
#include "printing/wash/run_off.hpp"

namespace pliant::wash {
namespace {

using machine::Axis;
using machine::Printer;

/// Maximum oscillation, by the interlocks' and the printer file's limits.
Strokes most_strokes(const Printer& p, double part_mm) {
    Strokes most;
    if (p.has_carriage()) {
        const machine::Carriage& c = p.carriage;
        most.x_um = c.tower_um - c.print_um - c.shear_um - c.back_off_um - 1;
    }
    // The stroke must also work for the tallest part of the machine, because the printer file is checked for that.
    const int tallest_um = std::max(p.platform.build_height_um, static_cast<int>(std::ceil(part_mm * 1000)));
    most.z_um = std::max(0, p.axis(Axis::platform).max_um - p.clear_um(tallest_um));
    return most;
}

/// Minimum duration of a cleaning: a stroke out and back at cleaning speed and, with a tower, the time to release the
/// vat, move the tower by one slot, and take the next vat, all while the pump runs.
double least_seconds(const Printer& p, const Strokes& strokes) {
    machine::Position far;
    far[Axis::carriage] = strokes.x_um;
    far[Axis::platform] = strokes.z_um;
    const double lead_um = p.has_carriage() ? strokes.x_um : strokes.z_um;
    if (p.has_carriage()) far[Axis::tower] = p.tower.pitch_um / 2;
    const double path_um = std::hypot(strokes.x_um, strokes.z_um, far[Axis::tower]);
    const double feed = lead_um > 0 ? p.cleaning.speed_mm_s * path_um / lead_um : 0;
    const double pair_s = 2 * machine::move_seconds(p, {}, far, feed);
    if (!p.has_carriage()) return pair_s;
    machine::Position hooks, back;
    hooks[Axis::tower] = p.hooks.travel_um;
    back[Axis::carriage] = p.carriage.back_off_um;
    const machine::Magnet& magnet = p.hooks.magnet;
    const double latch_s = magnet.present() ? magnet.release_s + magnet.engage_s
                                            : 2 * machine::move_seconds(p, {}, hooks, p.hooks.speed_mm_s);
    return pair_s + latch_s + 2 * machine::move_seconds(p, {}, back, 0);
}

class Search {
public:
    Search(const PartCells& part, const Printer& printer, double wanted)
        : part_(part), printer_(printer), faces_(wet_faces(part)), wanted_(wanted) {}

    /// Keeps the better one; practically equal results keep the shorter strokes.
    void attempt(const Strokes& strokes) {
        if (!tried_.insert({strokes.x_um, strokes.z_um}).second) return;
        const std::vector<double> rates = washed_rates(part_, faces_, printer_, strokes);
        const double most_s = printer_.limits.cleaning_s;
        const double most = cleanness(faces_, rates, most_s).removed;
        cleanest_ = std::max(cleanest_, most);
        if (most < wanted_) return;
        double low = 0, high = most_s;
        constexpr int halvings = 50;
        for (int i = 0; i < halvings; ++i) {
            const double middle = (low + high) / 2;
            (cleanness(faces_, rates, middle).removed < wanted_ ? low : high) = middle;
        }
        // Rounded up to tenths of a second, as in a printer file.
        const double seconds = std::ceil(10 * std::max(high, least_seconds(printer_, strokes)) - 1e-9) / 10;
        if (seconds > most_s || (best_ && seconds >= best_->seconds)) return;
        const Cleanness c = cleanness(faces_, rates, seconds);
        best_ = BestSpray{strokes, seconds, seconds * printer_.cleaning.solvent_ml_s, c.removed, c.unseen};
    }

    [[nodiscard]] const std::optional<BestSpray>& best() const { return best_; }
    [[nodiscard]] double cleanest() const { return cleanest_; }

private:
    const PartCells& part_;
    const Printer& printer_;
    std::vector<Face> faces_;
    double wanted_;
    std::set<std::pair<int, int>> tried_;
    std::optional<BestSpray> best_;
    double cleanest_ = 0;
};

int rounded_um(double um) {
    return static_cast<int>(std::lround(um / 100)) * 100;
}

}  // namespace

Result<BestSpray> best_spray(const PartCells& part, const Printer& printer, double wanted) {
    if (printer.sprinklers.empty()) return input_error("{} has no [[sprinkler]] tables", printer.name);
    if (!(printer.cleaning.solvent_ml_s > 0))
        return input_error("{} does not say how much solution a cleaning pumps (cleaning.solvent)", printer.name);
    if (!(wanted > 0 && wanted < 1)) return input_error("a cleanness of {:g}: must be above 0 and below 1", wanted);
    const Strokes most = most_strokes(printer, part.height_mm());
    Search search(part, printer, wanted);
    constexpr int coarse = 5;
    const int least_x_um = printer.has_carriage() ? 1000 : 0;
    for (int i = 0; i <= coarse; ++i) {
        for (int k = 0; k <= coarse; ++k)
            search.attempt({std::max(least_x_um, rounded_um(0.999 * most.x_um * i / coarse)),
                            rounded_um(0.999 * most.z_um * k / coarse)});
    }
    for (double step = 0.5 / coarse; step > 0.02 && search.best(); step /= 2) {
        const Strokes from = search.best()->strokes;
        for (int i = -1; i <= 1; ++i) {
            for (int k = -1; k <= 1; ++k) {
                const double x = std::clamp(from.x_um + i * step * most.x_um, static_cast<double>(least_x_um),
                                            std::max<double>(least_x_um, 0.999 * most.x_um));
                const double z = std::clamp(from.z_um + k * step * most.z_um, 0.0, 0.999 * most.z_um);
                search.attempt({rounded_um(x), rounded_um(z)});
            }
        }
    }
    if (search.best()) return *search.best();
    return input_error(
        "no oscillation cleans the part to {:.1f} %: at most {:.1f} % within {:g} s; no spray reaches the rest",
        100 * wanted, 100 * search.cleanest(), printer.limits.cleaning_s);
}

}  // namespace pliant::wash
