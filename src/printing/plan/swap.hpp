// Bringing and storing vats, for every kind of store.
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
// The spray lasts from step 2 to step 4: only then do the reported parts (24 + 3 + 15 + 24 s) give the reported 62 to
// 63 s. A magnet is switched instead of the strokes of the hooks in steps 2 and 4, and the tower goes directly from
// level to level.
//
// A wall: the same, but in step 3 the retriever puts the vat into its place, fetches the next one and brings it to the
// bay. That begins with the spray; if it takes longer, the spray still ends after its time, and the part dries until
// the vat arrives.
//
// A table: it moves to the cleaning station, the platform lowers the part into it, oscillates and rises again, and the
// table brings the next vat. A single vat: nothing ever moves.
//
// Precondition of all functions: the platform is clear of the vat; to store a vat with a brush, it is at
// Printer::push_um() of the part, where the brush reaches it.
#pragma once

#include "printing/plan/sequence.hpp"

namespace pliant::plan {

/// Brings the vat of `slot` to an empty carriage.
void load_vat(Sequence& sequence, int slot);

/// Stores the vat of `from_slot`, cleans the part, and brings the vat of `to_slot`.
void swap_vat(Sequence& sequence, int from_slot, int to_slot);

/// Stores the vat of `slot`, cleans and dries the part; the carriage returns empty.
void store_vat(Sequence& sequence, int slot);

/// Cleans and dries the part for `seconds` with no vat at the carriage (with a table: at the cleaning station); the
/// carriage then is back at the print position. Does nothing on a machine with a single vat.
void clean_part(Sequence& sequence, double seconds);

/// With the vat of `slot` under the platform and the tower anywhere: brings the tower level with the slot; with a wall,
/// the empty tray to the bay.
void meet_vat(Sequence& sequence, int slot);

/// A muted sequence with the vat of `slot` under the platform, which is at the height for storing the vat.
[[nodiscard]] Sequence standing_at(const machine::Printer& printer, int slot);

/// Duration of loading the first vat, from homed axes.
[[nodiscard]] Seconds load_seconds(const machine::Printer& printer, int slot);

/// Duration of one swap, from standing_at(from_slot).
[[nodiscard]] Seconds swap_seconds(const machine::Printer& printer, int from_slot, int to_slot);

}  // namespace pliant::plan
