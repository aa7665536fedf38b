// The cleaning solution on its way round (thesis, 4.3.2): a pump takes it out of a closed reservoir, what has cleaned
// the part runs through a drain and a filter back into it. Resin gathers in it until it is spent; what evaporates is
// topped up.
#pragma once

#include <optional>
#include <string_view>

#include "printing/machine/printer.hpp"

namespace pliant::machine {

/// What a person does to the circuit now and then.
enum class SolutionCare { change, top_up, clean_filter };

/// "change the cleaning solution", "top up the cleaning solution", "clean the filter of the drain".
[[nodiscard]] std::string_view care_text(SolutionCare care);

/// Well mixed; volumes in ml, those of resin and solution add up. On a machine without a [solution] table every
/// cleaning takes fresh solution, which is gone afterwards. The printer must outlive it.
class SolutionCircuit {
public:
    explicit SolutionCircuit(const Printer& printer);

    /// Time passes: some evaporates from the reservoir.
    void wait(double seconds);
    /// One cleaning pumps the solution of `seconds` and washes `washed_ml` of resin off.
    void clean(double seconds, double washed_ml);
    void care(SolutionCare care);

    /// The pump is not covered any more.
    [[nodiscard]] bool draws_air() const;
    /// What has to be done before it may go on, the most urgent first; nullopt: nothing.
    [[nodiscard]] std::optional<SolutionCare> needs() const;

    [[nodiscard]] bool goes_round() const { return printer_->solution.present(); }
    [[nodiscard]] double liquid_ml() const { return liquid_ml_; }  ///< in the reservoir, with the resin in it
    [[nodiscard]] double resin_ml() const { return resin_ml_; }    ///< dissolved
    [[nodiscard]] double resin_share() const { return liquid_ml_ > 0 ? resin_ml_ / liquid_ml_ : 0; }
    [[nodiscard]] double filter_ml() const { return filter_ml_; }  ///< resin that the filter has kept
    [[nodiscard]] double pumped_ml() const { return pumped_ml_; }
    /// Solution that is gone: evaporated, thrown away at a change, or, if it does not go round, pumped.
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
