// The oscillation of a part during cleaning: back and forth over the spray, while the store moves.
#pragma once

#include "printing/plan/sequence.hpp"

namespace pliant::plan {

/// Target of the store: the tower, or lift and rail of a retriever.
struct StoreEnd {
    int tower_um = 0, table_um = 0;
};

/// Present position of the store.
[[nodiscard]] StoreEnd store_at(const Sequence& sequence);

/// Pairs of strokes during which the store moves evenly to its end: as many as fit in `seconds`, at least one, then
/// waiting for the remainder.
void oscillate(Sequence& sequence, const StoreEnd& store, double seconds);

/// The same, but as many as fill `seconds`, without waiting.
void oscillate_through(Sequence& sequence, const StoreEnd& store, double seconds);

}  // namespace pliant::plan
