#include "printing/plan/solution_use.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "printing/machine/cleaning_data.hpp"
#include "printing/plan/departures.hpp"
#include "printing/plan/plan.hpp"
#include "printing/plan/swap.hpp"

namespace pliant::plan {
namespace {

using machine::Printer;
using machine::SolutionCare;
using machine::SolutionCircuit;

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

/// The part has left a vat and is cleaned.
struct Cleaning {
    Departure after;
    double seconds = 0;
};

/// The cleanings before and within each layer; the one at the end counts with the last printed layer.
std::vector<std::vector<Cleaning>> cleanings(const Plan& plan, const job::Manifest& job, const Printer& printer) {
    std::vector<std::vector<Cleaning>> all(plan.order.size());
    PumpTimes pump(printer);
    for (const Departure& d : departures(plan.order, plan.vat_of_image, job, printer))
        all[d.layer].push_back({d, pump.seconds(d.vat, d.next)});
    return all;
}

void add_waste(Plan& plan, const Departure& d, const Printer& printer) {
    const auto use = std::find_if(plan.vats.begin(), plan.vats.end(), [&](const VatUse& u) { return u.vat == d.vat; });
    const double brushed_ml = d.film_ml * printer.brushed_share();
    const double wasted_ml = d.film_ml - brushed_ml;
    use->brushed_ml += brushed_ml;
    use->waste_ml += wasted_ml;
    plan.brushed_ml += brushed_ml;
    plan.waste_ml += wasted_ml;
}

/// Applies the cleanings and the duration of one layer.
void pass_layer(SolutionCircuit& circuit, const std::vector<Cleaning>& layer, double seconds, const Printer& printer) {
    const machine::CleaningLaw law = machine::cleaning_law(printer.cleaning.method);
    for (const Cleaning& c : layer) {
        const double on_part_ml = c.after.film_ml * (1 - printer.brushed_share());
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
        for (const Cleaning& c : layers[i]) add_waste(plan, c.after, printer);
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
