// Trips of a wall's retriever: putting a vat into its place and fetching another one.
#pragma once

#include <vector>

#include "printing/machine/interlock.hpp"
#include "printing/machine/printer.hpp"
#include "printing/plan/sequence.hpp"

namespace pliant::plan {

/// One step: a straight move of lift and rail, or a stroke of the fork.
struct RetrieverStep {
    enum class Kind { way, fork_out, fork_in };
    Kind kind = Kind::way;
    int lift_um = 0, rail_um = 0;  ///< end of a move
    double feed_mm_s = 0;          ///< of a move; 0: as fast as the axes can
};
using RetrieverTrip = std::vector<RetrieverStep>;

/// From any position, with the vat of `slot` on the tray: into its place.
[[nodiscard]] RetrieverTrip put_trip(const machine::Printer& printer, int slot);
/// From any position, with an empty tray: fetches the vat of `slot` and goes to the bay, where the hooks of the
/// carriage are clear of it.
[[nodiscard]] RetrieverTrip fetch_trip(const machine::Printer& printer, int slot);

/// Appends the steps in order; for a stroke of the fork also the wait.
void ride(Sequence& sequence, const RetrieverTrip& trip);

/// Empties the retriever from any state: a fork in the wall leaves its vat in the place before it and retracts, a vat
/// on the tray goes into its place. Requires the carriage back, or its vat under the platform, and all axes homed.
void clear_retriever(Sequence& sequence, const machine::Interlock& state);

}  // namespace pliant::plan
