#include "printing/plan/solution_use.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "printing/machine/cleaning_data.hpp"
#include "printing/plan/plan.hpp"
#include "printing/plan/swap.hpp"

namespace pliant::plan {
namespace {

using machine::Printer;
using machine::SolutionCare;
using machine::SolutionCircuit;

/// The part leaves a vat and is cleaned.
struct Cleaning {
    int vat = 0;
    double film_ml = 0;  ///< on the part before wiping or cleaning
    double seconds = 0;
};

/// The area that resin adheres to when the part leaves a vat: its lower end. It is the area cured in the current layer
/// or, while that is smaller, in the layer before. The virtual printer uses the same rule (printing/twin/cure.hpp).
class LowerEnd {
public:
    LowerEnd(const Plan& plan, const job::Manifest& job) : plan_(plan), job_(job) {}

    /// `vat` has finished its part of a layer.
    void print(std::size_t layer, int vat) {
        if (layer != layer_) before_mm2_ = std::exchange(now_mm2_, 0);
        layer_ = layer;
        const std::vector<job::LayerImage>& images = job_.layers[layer].images;
        for (std::size_t k = 0; k < images.size(); ++k) {
            if (plan_.vat_of_image[layer][k] == vat) now_mm2_ += images[k].area_mm2;
        }
    }
    [[nodiscard]] double film_ml(const Printer& printer) const {
        return std::max(now_mm2_, before_mm2_) * printer.cleaning.film_um / 1e6;
    }

private:
    const Plan& plan_;
    const job::Manifest& job_;
    std::size_t layer_ = 0;
    double now_mm2_ = 0, before_mm2_ = 0;
};

/// How long the pump runs in a swap, or while the last vat is stored (`to` is -1): the required time, or longer if the
/// store takes longer to bring the vat.
class PumpTimes {
public:
    explicit PumpTimes(const Printer& printer) : printer_(printer) {}

    double seconds(int from, int to) {
        double& known = known_[{from, to}];
        if (known > 0) return known;
        const double asked_s = to < 0 ? printer_.cleaning.spray_s : printer_.cleaning_s(from, to);
        Sequence s = standing_at(printer_, printer_.slot_of(from));
        if (to < 0)
            store_vat(s, printer_.slot_of(from));
        else
            swap_vat(s, printer_.slot_of(from), printer_.slot_of(to));
        return known = std::max(asked_s, s.seconds().clean);
    }

private:
    const Printer& printer_;
    std::map<std::pair<int, int>, double> known_;
};

/// The cleanings before and within each layer; the one at the end counts with the last printed layer.
std::vector<std::vector<Cleaning>> cleanings(const Plan& plan, const job::Manifest& job, const Printer& printer) {
    std::vector<std::vector<Cleaning>> all(plan.order.size());
    PumpTimes pump(printer);
    LowerEnd end(plan, job);
    int loaded = -1;
    std::size_t last_layer = 0;
    for (std::size_t i = 0; i < plan.order.size(); ++i) {
        for (const int vat : plan.order[i]) {
            if (loaded >= 0 && loaded != vat)
                all[i].push_back({loaded, end.film_ml(printer), pump.seconds(loaded, vat)});
            end.print(i, vat);
            loaded = vat;
            last_layer = i;
        }
    }
    if (loaded >= 0 && printer.store() != machine::Store::none)
        all[last_layer].push_back({loaded, end.film_ml(printer), pump.seconds(loaded, -1)});
    return all;
}

/// Of a cleaning before or within a layer.
void add_waste(Plan& plan, const Cleaning& c, int layer, const Printer& printer) {
    const auto use = std::find_if(plan.vats.begin(), plan.vats.end(), [&](const VatUse& u) { return u.vat == c.vat; });
    const double brushed_ml = c.film_ml * printer.brushed_share();
    const double wasted_ml = c.film_ml - brushed_ml;
    use->brushed_ml += brushed_ml;
    use->waste_ml += wasted_ml;
    plan.brushed_ml += brushed_ml;
    plan.waste_ml += wasted_ml;
    const std::vector<int> refills = plan.refills_of(use->slot);
    if (refills.empty() || layer < refills.front()) use->needed_ml += wasted_ml;
}

/// Applies the cleanings and the duration of one layer.
void pass_layer(SolutionCircuit& circuit, const std::vector<Cleaning>& layer, double seconds, const Printer& printer) {
    const machine::CleaningLaw law = machine::cleaning_law(printer.cleaning.method);
    for (const Cleaning& c : layer) {
        const double on_part_ml = c.film_ml * (1 - printer.brushed_share());
        circuit.clean(c.seconds, on_part_ml * law.removed(c.seconds) * (1 - circuit.resin_share()));
    }
    circuit.wait(seconds);
}

/// Determines the service needed before a layer so that the circuit lasts through it.
void look_after(SolutionCircuit& circuit, const std::vector<Cleaning>& layer, double seconds, int index,
                const Printer& printer, std::vector<CareBefore>& care) {
    SolutionCircuit ahead = circuit;
    pass_layer(ahead, layer, seconds, printer);
    constexpr int kinds = 3;
    for (int i = 0; i < kinds; ++i) {
        const auto needed = circuit.needs() ? circuit.needs() : ahead.needs();
        if (!needed) return;
        const bool again = !care.empty() && care.back().layer == index && care.back().care == *needed;
        if (again) return;  // one layer needs more than a fresh circuit can give
        care.push_back({index, *needed});
        circuit.care(*needed);
        ahead = circuit;
        pass_layer(ahead, layer, seconds, printer);
    }
}

}  // namespace

void reckon_solution(Plan& plan, const job::Manifest& job, const Printer& printer) {
    const auto layers = cleanings(plan, job, printer);
    SolutionCircuit circuit(printer);
    SolutionUse use;
    use.goes_round = circuit.goes_round();
    for (std::size_t i = 0; i < layers.size(); ++i) {
        const double seconds = i < plan.layer_seconds.size() ? plan.layer_seconds[i].total : 0;
        if (!layers[i].empty()) look_after(circuit, layers[i], seconds, static_cast<int>(i), printer, use.care);
        pass_layer(circuit, layers[i], seconds, printer);
        for (const Cleaning& c : layers[i]) add_waste(plan, c, static_cast<int>(i), printer);
    }
    for (const CareBefore& care : use.care) {
        if (care.layer == 0) plan.warnings.push_back(fmt::format("{} before the print", machine::care_text(care.care)));
    }
    use.pumped_ml = circuit.pumped_ml();
    use.used_ml = plan.solvent_ml = circuit.used_ml();
    use.liquid_ml = circuit.liquid_ml();
    use.resin_share = circuit.resin_share();
    use.spent_share = printer.solution.spent_share;
    use.filter_ml = circuit.filter_ml();
    plan.solution = std::move(use);
}

}  // namespace pliant::plan
