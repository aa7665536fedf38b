// The oscillation of a part that is cleaned: back and forth over the spray, while the store does its own.
#pragma once

#include "printing/plan/sequence.hpp"

namespace pliant::plan {

/// Where the store is to end: the tower, or lift and rail of a retriever.
struct StoreEnd {
    int tower_um = 0, table_um = 0;
};

/// Where the store stands.
[[nodiscard]] StoreEnd store_at(const Sequence& sequence);

/// Pairs of strokes that carry the store evenly to its end, as many as `seconds` allow but at least one, then a rest
/// for what is left of them.
void oscillate(Sequence& sequence, const StoreEnd& store, double seconds);

/// The same, but as many as fill `seconds`: no rest.
void oscillate_through(Sequence& sequence, const StoreEnd& store, double seconds);

}  // namespace pliant::plan
