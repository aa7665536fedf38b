#include "printing/twin/fluids.hpp"

#include <algorithm>
#include <numeric>

namespace pliant::twin {

Fluids::Fluids(const machine::Printer& printer)
    : printer_(&printer), law_(machine::cleaning_law(printer.cleaning.method)), solution_(printer) {
    for (const machine::Vat& vat : printer.vats) {
        auto found = std::find(resins_.begin(), resins_.end(), vat.resin);
        if (found == resins_.end()) found = resins_.insert(resins_.end(), vat.resin);
        own_.push_back(static_cast<int>(found - resins_.begin()));
    }
    if (printer.solution.resin_share > 0) resins_.emplace_back("from earlier prints");
    film_ml_.resize(resins_.size());
    dissolved_.resize(resins_.size());
    if (printer.solution.resin_share > 0) dissolved_.back() = 1;
    for (const int own : own_) {
        mixture_.emplace_back(resins_.size());
        mixture_.back()[static_cast<std::size_t>(own)] = 1;
    }
}

double Fluids::leave(int vat, double section_mm2, double brushed) {
    const double film_ml = section_mm2 * printer_->cleaning.film_um / 1e6;
    const double ml = film_ml * (1 - brushed);
    brushed_ml_ += film_ml * brushed;
    for (std::size_t r = 0; r < film_ml_.size(); ++r) film_ml_[r] = ml * mixture_[static_cast<std::size_t>(vat)][r];
    return ml;
}

double Fluids::clean(double seconds, std::optional<double> known) {
    const double removed = known.value_or(law_.removed(seconds)), stays = solution_.resin_share();
    const double film = std::accumulate(film_ml_.begin(), film_ml_.end(), 0.0);
    const double before = solution_.resin_ml();
    std::vector<double> washed(film_ml_.size());
    for (std::size_t r = 0; r < film_ml_.size(); ++r) {
        const double ml = film_ml_[r];
        film_ml_[r] = ml * (1 - removed) + film * removed * stays * dissolved_[r];
        washed[r] = ml - film_ml_[r];
    }
    const double off = std::accumulate(washed.begin(), washed.end(), 0.0);
    solution_.clean(seconds, off);
    mix(washed, off, before);
    washed_ml_ += off;
    return 1 - removed * (1 - stays);
}

/// Updates the resin in the solution, `before` ml, after washing off another `off` ml.
void Fluids::mix(const std::vector<double>& washed, double off, double before) {
    const double after = solution_.resin_ml();
    if (off <= 0 || after <= before) return;
    for (std::size_t r = 0; r < washed.size(); ++r)
        dissolved_[r] = (dissolved_[r] * before + washed[r] / off * (after - before)) / after;
}

void Fluids::care(machine::SolutionCare care) {
    solution_.care(care);
    if (solution_.resin_ml() <= 0) std::fill(dissolved_.begin(), dissolved_.end(), 0.0);
}

void Fluids::advance_to(double now_s) {
    solution_.wait(std::max(0.0, now_s - now_s_));
    now_s_ = std::max(now_s_, now_s);
}

double Fluids::enter(int vat, double vat_ml) {
    const double film = std::accumulate(film_ml_.begin(), film_ml_.end(), 0.0);
    const double all = std::max(0.0, vat_ml) + film;
    if (film <= 0 || all <= 0) return 0;
    std::vector<double>& mixture = mixture_[static_cast<std::size_t>(vat)];
    for (std::size_t r = 0; r < mixture.size(); ++r) mixture[r] = (mixture[r] * (all - film) + film_ml_[r]) / all;
    std::fill(film_ml_.begin(), film_ml_.end(), 0);
    return film;
}

void Fluids::wipe() {
    std::fill(film_ml_.begin(), film_ml_.end(), 0.0);
}

void Fluids::pour(int vat, double vat_ml, double ml) {
    const double all = std::max(0.0, vat_ml) + ml;
    if (ml <= 0 || all <= 0) return;
    std::vector<double>& mixture = mixture_[static_cast<std::size_t>(vat)];
    for (double& share : mixture) share *= (all - ml) / all;
    mixture[static_cast<std::size_t>(own_[static_cast<std::size_t>(vat)])] += ml / all;
}

double Fluids::share(int vat, int resin) const {
    return mixture_[static_cast<std::size_t>(vat)][static_cast<std::size_t>(resin)];
}

double Fluids::foreign_share(int vat) const {
    return std::max(0.0, 1 - share(vat, own_[static_cast<std::size_t>(vat)]));
}

}  // namespace pliant::twin
