// Brings a new virtual printer to the state that the journal of an interrupted print describes: part, vats, axes. A
// real machine keeps its state; a virtual one is lost with its program.
#pragma once

#include <vector>

#include "base/core/error.hpp"
#include "printing/host/control_types.hpp"
#include "printing/host/journal.hpp"
#include "printing/twin/twin.hpp"

namespace pliant::rehearse {

/// Repeats in order what the journal proves to have been done: commands of the job and of other programs up to the last
/// point where the machine stood still, every exposure for its actual duration (one without an end in the journal: not
/// at all), refills. The twin's controller then has the matching line number, so that a host that asks for it knows
/// where the machine is. A journal in which nothing has begun changes nothing. Precondition: the twin is in its initial
/// state, with its vats filled. Errors: a journal of another job, or one with points that the machine does not pass; an
/// image that cannot be read. Cost: that of the virtual print, without waiting.
[[nodiscard]] Status replay(const std::vector<host::JournalRecord>& records, const host::PrintJob& job,
                            twin::Twin& twin);

}  // namespace pliant::rehearse
