// The ways of the retriever of a wall of vats: what it does to put a vat into its place and to bring another one.
#pragma once

#include <vector>

#include "printing/machine/interlock.hpp"
#include "printing/machine/printer.hpp"
#include "printing/plan/sequence.hpp"

namespace pliant::plan {

/// One step: a straight way of lift and rail, or a stroke of the fork.
struct RetrieverStep {
    enum class Kind { way, fork_out, fork_in };
    Kind kind = Kind::way;
    int lift_um = 0, rail_um = 0;  ///< where a way ends
    double feed_mm_s = 0;          ///< of a way; 0: as fast as the axes go
};
using RetrieverTrip = std::vector<RetrieverStep>;

/// From anywhere, with the vat of `slot` on the tray: into its place.
[[nodiscard]] RetrieverTrip put_trip(const machine::Printer& printer, int slot);
/// From anywhere, with an empty tray: the vat of `slot`, and to the bay, where the hooks of the carriage are clear of
/// it.
[[nodiscard]] RetrieverTrip fetch_trip(const machine::Printer& printer, int slot);

/// The steps one after the other; of a fork's stroke the wait too.
void ride(Sequence& sequence, const RetrieverTrip& trip);

/// The retriever becomes empty from wherever it is: a fork in the wall leaves its vat in the place before it and comes
/// in, a vat on the tray goes into its place. Needs the carriage back, or its vat under the platform, and all axes
/// homed.
void clear_retriever(Sequence& sequence, const machine::Interlock& state);

}  // namespace pliant::plan
