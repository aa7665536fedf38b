// Resin on its way from vat to vat: what clings to the part, what cleaning leaves of it, what it makes of the next vat.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "printing/machine/cleaning_data.hpp"
#include "printing/machine/printer.hpp"
#include "printing/machine/solution.hpp"

namespace pliant::twin {

/// Well mixed vats and one film on the part. Resins are numbered as resins() lists them.
class Fluids {
public:
    explicit Fluids(const machine::Printer& printer);

    /// The part leaves a vat with a film over `section_mm2` of it, of which a brush returns the share `brushed`. What
    /// the vat loses, in ml.
    double leave(int vat, double section_mm2, double brushed = 0);
    /// The part is cleaned; by the law of the machine's method (thesis, table 4.2). Where solution with resin in it
    /// replaces the film, that resin stays. `removed`: what fresh solution takes off, where it is known better than by
    /// that law. The share of the film that is left.
    double clean(double seconds, std::optional<double> removed = {});
    /// Somebody looks after the cleaning solution.
    void care(machine::SolutionCare care);
    /// The clock; solution evaporates.
    void advance_to(double now_s);
    /// The part comes into a vat that holds `vat_ml`: what is left of the film mixes in. What the vat gains, in ml.
    double enter(int vat, double vat_ml);

    /// The part is gone, and the film on it.
    void wipe();
    /// Fresh resin into a vat that holds `vat_ml`.
    void pour(int vat, double vat_ml, double ml);

    /// Share of what a vat holds that is another resin than its own.
    [[nodiscard]] double foreign_share(int vat) const;
    /// Share of one resin in a vat.
    [[nodiscard]] double share(int vat, int resin) const;
    [[nodiscard]] const std::vector<std::string>& resins() const { return resins_; }
    [[nodiscard]] const machine::SolutionCircuit& solution() const { return solution_; }
    /// Resin that cleaning has washed off, in ml.
    [[nodiscard]] double washed_ml() const { return washed_ml_; }
    /// Resin that brushes have wiped off the part, back into its vats, in ml.
    [[nodiscard]] double brushed_ml() const { return brushed_ml_; }

private:
    void mix(const std::vector<double>& washed, double off, double before);

    const machine::Printer* printer_;
    machine::CleaningLaw law_;
    std::vector<std::string> resins_;
    std::vector<int> own_;                      ///< resin of each vat
    std::vector<std::vector<double>> mixture_;  ///< (vats, resins), shares
    std::vector<double> film_ml_;               ///< by resin
    machine::SolutionCircuit solution_;
    std::vector<double> dissolved_;  ///< by resin: shares of the resin in the solution
    double now_s_ = 0;
    double washed_ml_ = 0;
    double brushed_ml_ = 0;
};

}  // namespace pliant::twin
