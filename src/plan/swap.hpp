// Bringing vats from the tower and back: the swap of the thesis (chapter 4), step by step.
//
//   1  the carriage pushes the vat into the tower; the brush wipes the part on the way
//   2  the pump starts; the tower lowers, the hooks come free
//   3  the cleaning vat backs off and oscillates in X, the platform in Z, while the tower brings the next slot
//   4  the carriage advances, the tower rises, the hooks engage; the pump stops
//   5  the vat is pulled in while the fans dry the part
//
// The spray lasts from step 2 to step 4: only so do the reported parts (24 + 3 + 15 + 24 s) give the reported 62 to
// 63 s. All of it needs the platform clear of the vat before.
#pragma once

#include "plan/sequence.hpp"

namespace pliant::plan {

/// Brings the vat of `slot` to an empty carriage.
void load_vat(Sequence& sequence, int slot);

/// Puts the vat of `from_slot` away, cleans the part, and brings the vat of `to_slot`.
void swap_vat(Sequence& sequence, int from_slot, int to_slot);

/// Puts the vat of `slot` away, cleans and dries the part; the carriage comes back empty.
void store_vat(Sequence& sequence, int slot);

}  // namespace pliant::plan
