// The circuit of the cleaning solution (thesis, 4.3.2): a pump takes it from a closed reservoir; after cleaning the
// part it returns through a drain and a filter. Resin accumulates until the solution is spent; evaporation losses are
// topped up.
#pragma once

#include <optional>
#include <string_view>

#include "printing/machine/printer.hpp"

namespace pliant::machine {

/// Maintenance of the circuit by the operator.
enum class SolutionCare { change, top_up, clean_filter };

/// "change the cleaning solution", "top up the cleaning solution", "clean the filter of the drain".
[[nodiscard]] std::string_view care_text(SolutionCare care);

/// Assumes perfect mixing; volumes in ml, additive for resin and solution. On a machine without a [solution] table
/// every cleaning takes fresh solution, which is lost. The printer must outlive it.
class SolutionCircuit {
public:
    explicit SolutionCircuit(const Printer& printer);

    /// Time passes: some solution evaporates from the reservoir.
    void wait(double seconds);
    /// One cleaning pumps solution for `seconds` and washes off `washed_ml` of resin.
    void clean(double seconds, double washed_ml);
    void care(SolutionCare care);

    /// The level is too low for the pump.
    [[nodiscard]] bool draws_air() const;
    /// The most urgent maintenance needed before continuing; nullopt: none.
    [[nodiscard]] std::optional<SolutionCare> needs() const;

    [[nodiscard]] bool goes_round() const { return printer_->solution.present(); }
    [[nodiscard]] double liquid_ml() const { return liquid_ml_; }  ///< in the reservoir, including resin
    [[nodiscard]] double resin_ml() const { return resin_ml_; }    ///< dissolved
    [[nodiscard]] double resin_share() const { return liquid_ml_ > 0 ? resin_ml_ / liquid_ml_ : 0; }
    [[nodiscard]] double filter_ml() const { return filter_ml_; }  ///< resin retained by the filter
    [[nodiscard]] double pumped_ml() const { return pumped_ml_; }
    /// Solution consumed: evaporated, discarded at a change or, without a circuit, pumped.
    [[nodiscard]] double used_ml() const { return used_ml_; }

private:
    void evaporate(double ml);

    const Printer* printer_;
    double liquid_ml_ = 0;
    double resin_ml_ = 0;
    double filter_ml_ = 0;
    double pumped_ml_ = 0;
    double used_ml_ = 0;
};

}  // namespace pliant::machine
