#include "printing/machine/solution.hpp"

#include <algorithm>

namespace pliant::machine {

std::string_view care_text(SolutionCare care) {
    switch (care) {
        case SolutionCare::change:
            return "change the cleaning solution";
        case SolutionCare::top_up:
            return "top up the cleaning solution";
        case SolutionCare::clean_filter:
            break;
    }
    return "clean the filter of the drain";
}

SolutionCircuit::SolutionCircuit(const Printer& printer)
    : printer_(&printer),
      liquid_ml_(printer.solution.fill_ml),
      resin_ml_(printer.solution.fill_ml * printer.solution.resin_share) {}

/// The resin stays behind.
void SolutionCircuit::evaporate(double ml) {
    const double gone = std::clamp(ml, 0.0, liquid_ml_ - resin_ml_);
    liquid_ml_ -= gone;
    used_ml_ += gone;
}

void SolutionCircuit::wait(double seconds) {
    if (goes_round()) evaporate(printer_->solution.evaporation_ml_h * seconds / 3600);
}

void SolutionCircuit::clean(double seconds, double washed_ml) {
    const double pumped_ml = printer_->cleaning.solvent_ml_s * seconds;
    pumped_ml_ += pumped_ml;
    if (!goes_round()) {
        used_ml_ += pumped_ml;
        return;
    }
    const Solution& s = printer_->solution;
    const double kept_ml = std::min(washed_ml * s.filter_share, std::max(0.0, s.filter_ml - filter_ml_));
    filter_ml_ += kept_ml;
    resin_ml_ += washed_ml - kept_ml;
    liquid_ml_ += washed_ml - kept_ml;
    evaporate(pumped_ml * s.spray_loss);
}

void SolutionCircuit::care(SolutionCare care) {
    if (!goes_round()) return;
    switch (care) {
        case SolutionCare::change:
            used_ml_ += liquid_ml_ - resin_ml_;
            liquid_ml_ = printer_->solution.volume_ml;
            resin_ml_ = 0;
            break;
        case SolutionCare::top_up:
            liquid_ml_ = std::max(liquid_ml_, printer_->solution.volume_ml);
            break;
        case SolutionCare::clean_filter:
            filter_ml_ = 0;
            break;
    }
}

bool SolutionCircuit::draws_air() const {
    return goes_round() && liquid_ml_ < printer_->solution.least_ml;
}

std::optional<SolutionCare> SolutionCircuit::needs() const {
    if (!goes_round()) return std::nullopt;
    if (resin_share() >= printer_->solution.spent_share) return SolutionCare::change;
    if (draws_air()) return SolutionCare::top_up;
    const Solution& s = printer_->solution;
    if (s.filter_ml > 0 && filter_ml_ >= s.filter_ml) return SolutionCare::clean_filter;
    return std::nullopt;
}

}  // namespace pliant::machine
