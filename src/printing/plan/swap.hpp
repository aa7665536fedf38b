// Bringing vats and putting them away, whatever the store of the machine.
//
// A tower: the swap of the thesis (chapter 4), step by step.
//
//   1  the carriage pushes the vat into the tower; the brush wipes the part on the way
//   2  the pump starts; the tower lowers, the hooks come free, and the platform rises off the brush
//   3  the cleaning vat backs off and oscillates in X, the platform in Z, while the tower brings the next slot (of
//      several towers, the table first brings the right one)
//   4  the carriage advances, the tower rises, the hooks engage; the pump stops
//   5  the vat is pulled in while the fans dry the part
//
// The spray lasts from step 2 to step 4: only so do the reported parts (24 + 3 + 15 + 24 s) give the reported 62 to
// 63 s. A magnet is switched instead of the strokes of the hooks in steps 2 and 4, and the tower goes straight from
// level to level.
//
// A wall: the same, but in step 3 the retriever puts the vat into its place, takes the next one out of its own and
// brings it to the bay. That begins with the spray; where it takes longer the spray ends after its time, and the part
// dries until the vat comes.
//
// A table: it turns or shifts to the cleaning station, the platform lowers the part into it and oscillates, rises
// again, and the table brings the next vat. A single vat: nothing ever moves.
//
// All of it needs the platform clear of the vat before; to put a vat away that has a brush, at Printer::push_um() of
// the part, where the brush reaches it.
#pragma once

#include "printing/plan/sequence.hpp"

namespace pliant::plan {

/// Brings the vat of `slot` to an empty carriage.
void load_vat(Sequence& sequence, int slot);

/// Puts the vat of `from_slot` away, cleans the part, and brings the vat of `to_slot`.
void swap_vat(Sequence& sequence, int from_slot, int to_slot);

/// Puts the vat of `slot` away, cleans and dries the part; the carriage comes back empty.
void store_vat(Sequence& sequence, int slot);

/// Cleans and dries the part for `seconds` with no vat at the carriage (of a table: at the cleaning station), which is
/// back at the print position afterwards. Nothing on a machine with a single vat.
void clean_part(Sequence& sequence, double seconds);

/// The vat of `slot` lies under the platform and the tower stands anywhere: brings the tower level with the slot; of a
/// wall the empty tray to the bay.
void meet_vat(Sequence& sequence, int slot);

/// A muted sequence that stands with the vat of `slot` under a platform that is ready for it to be put away.
[[nodiscard]] Sequence standing_at(const machine::Printer& printer, int slot);

/// What loading the first vat takes, from homed axes.
[[nodiscard]] Seconds load_seconds(const machine::Printer& printer, int slot);

/// What one swap takes, from standing_at(from_slot).
[[nodiscard]] Seconds swap_seconds(const machine::Printer& printer, int from_slot, int to_slot);

}  // namespace pliant::plan
