// A virtual printer brought to where the journal of an interrupted print says that one has been left: its part, its
// vats, its axes. A real machine keeps them; a virtual one is gone with the program that it was in.
#pragma once

#include <vector>

#include "base/core/error.hpp"
#include "printing/host/control_types.hpp"
#include "printing/host/journal.hpp"
#include "printing/twin/twin.hpp"

namespace pliant::rehearse {

/// Carries out again, in the order of the journal, what it proves to have been done: commands of the job and of other
/// programs up to the last place where the machine stood still, every light for as long as it was on (of a light whose
/// end is not in the journal nothing), refills. The twin's controller then has the line number that belongs to it, so
/// that a host that asks for it knows where the machine stands. A journal in which nothing has begun changes nothing.
/// Precondition: the twin stands at its beginning, with its vats filled. Errors: a journal of another job, one whose
/// places the machine does not come by; an image that cannot be read. Cost: that of the virtual print, without waiting.
[[nodiscard]] Status replay(const std::vector<host::JournalRecord>& records, const host::PrintJob& job,
                            twin::Twin& twin);

}  // namespace pliant::rehearse
