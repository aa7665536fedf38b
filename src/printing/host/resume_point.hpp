// Where an interrupted print resumes: what the journal and the controller together prove.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "printing/host/control_types.hpp"
#include "printing/host/journal_facts.hpp"
#include "printing/host/script.hpp"

namespace pliant::host {

/// Errors: a record about a step, layer or material that the job does not have.
[[nodiscard]] Status check_fits(const JournalFacts& facts, const Script& script, const PrintJob& job);

/// The machine where the journal last knows it. Errors: slots or vats that the printer does not have; they name the
/// record. Precondition: `facts.go`.
[[nodiscard]] Result<machine::Interlock> last_known(const JournalFacts& facts, const machine::Printer& printer);

/// The machine's present state. `state` has no axis homed if the controller has lost its position.
struct Standing {
    machine::Interlock state;
    bool on_hooks = false;  ///< position on the hooks is unknown
};

/// `last_line`: the controller's last line number; 0: it was reset. A number that fits the journal proves that
/// everything sent was carried out, and that the position is valid. Errors: a number from another program, unless
/// `assume` says that no vat was touched.
[[nodiscard]] Result<Standing> standing_of(const JournalFacts& facts, const Script& script,
                                           const machine::Printer& printer, long last_line, const Assume& assume);

/// An exposure whose end is not in the journal, and how long it lasted.
struct OpenLight {
    long light = 0;
    double on_s = 0;
    bool complete = false;
    bool assumed = false;
};

/// nullopt: there is none. Errors: there is one whose end was not observed: `assume` must give its duration.
/// `materials`: names for the message.
[[nodiscard]] Result<std::optional<OpenLight>> close_open_light(JournalFacts& facts, Guard* guard, const Assume& assume,
                                                                const std::vector<std::string>& materials);

/// The first step whose exposure is incomplete; the number of steps if there is none.
[[nodiscard]] std::size_t next_light(const JournalFacts& facts, const Script& script);

/// Errors: the journal refers to a step that the script does not have (another job).
[[nodiscard]] Result<Recovery> recovery_of(const JournalFacts& facts, const Script& script,
                                           const machine::Printer& printer, const Standing& standing);

/// Errors: the last session ended with a controller that has lost its position, or loses it by the reset that it needs,
/// where `resume`, as in Programs, has no way on from there.
[[nodiscard]] Status check_way_on(const JournalFacts& facts, const Script& script, const machine::Printer& printer,
                                  const std::function<Result<std::string>(const Recovery&)>& resume);

/// Whether the missing exposure is small enough to be ignored.
[[nodiscard]] bool is_enough(double lit_s, double planned_s);

}  // namespace pliant::host
