// Carry-over of resin between vats: the film on the part, what cleaning leaves of it, and the contamination of the next
// vat.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "printing/machine/cleaning_data.hpp"
#include "printing/machine/printer.hpp"
#include "printing/machine/solution.hpp"

namespace pliant::twin {

/// Perfectly mixed vats and one film on the part. Resins are numbered as in resins().
class Fluids {
public:
    explicit Fluids(const machine::Printer& printer);

    /// The part leaves a vat with a film on `section_mm2` of its surface, of which a brush returns the fraction
    /// `brushed`. Returns the vat's loss in ml.
    double leave(int vat, double section_mm2, double brushed = 0);
    /// Cleans the part, by the law of the machine's method (thesis, table 4.2). Where solution with dissolved resin
    /// replaces the film, that resin stays. `removed`: fraction that fresh solution removes, if known better than by
    /// that law. Returns the fraction of the film that is left.
    double clean(double seconds, std::optional<double> removed = {});
    /// Maintenance of the cleaning solution.
    void care(machine::SolutionCare care);
    /// Advances the clock; solution evaporates.
    void advance_to(double now_s);
    /// The part enters a vat that holds `vat_ml`: the rest of the film mixes in. Returns the vat's gain in ml.
    double enter(int vat, double vat_ml);

    /// The part is removed, with the film on it.
    void wipe();
    /// Adds fresh resin to a vat that holds `vat_ml`.
    void pour(int vat, double vat_ml, double ml);

    /// Fraction of a vat's content that is not its own resin.
    [[nodiscard]] double foreign_share(int vat) const;
    /// Fraction of one resin in a vat.
    [[nodiscard]] double share(int vat, int resin) const;
    [[nodiscard]] const std::vector<std::string>& resins() const { return resins_; }
    [[nodiscard]] const machine::SolutionCircuit& solution() const { return solution_; }
    /// Resin washed off by cleaning, in ml.
    [[nodiscard]] double washed_ml() const { return washed_ml_; }
    /// Resin that brushes have wiped off the part, back into its vats, in ml.
    [[nodiscard]] double brushed_ml() const { return brushed_ml_; }

private:
    void mix(const std::vector<double>& washed, double off, double before);

    const machine::Printer* printer_;
    machine::CleaningLaw law_;
    std::vector<std::string> resins_;
    std::vector<int> own_;                      ///< resin of each vat
    std::vector<std::vector<double>> mixture_;  ///< (vats, resins), fractions
    std::vector<double> film_ml_;               ///< by resin
    machine::SolutionCircuit solution_;
    std::vector<double> dissolved_;  ///< by resin: fractions of the resin in the solution
    double now_s_ = 0;
    double washed_ml_ = 0;
    double brushed_ml_ = 0;
};

}  // namespace pliant::twin
