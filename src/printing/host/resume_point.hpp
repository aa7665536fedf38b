// Where an interrupted print goes on: what the journal and the controller prove together.
#pragma once

#include <cstddef>
#include <optional>

#include "base/core/error.hpp"
#include "printing/host/control_types.hpp"
#include "printing/host/journal_facts.hpp"
#include "printing/host/script.hpp"

namespace pliant::host {

/// Where the machine stands. `state` has no axis homed if the controller has lost its position.
struct Standing {
    machine::Interlock state;
    bool on_hooks = false;  ///< and nobody knows how far
};

/// `last_line`: the controller's last line number; 0: it has been reset. One that fits the journal proves that what was
/// sent has been carried out, and that the position holds. Errors: a number of somebody else's, unless told that no vat
/// was touched.
[[nodiscard]] Result<Standing> standing_of(const JournalFacts& facts, const Script& script,
                                           const machine::Printer& printer, long last_line, const Assume& assume);

/// A light whose end is not in the journal, and how long it was on.
struct OpenLight {
    long light = 0;
    double on_s = 0;
    bool complete = false;
    bool assumed = false;
};

/// nullopt: there is none. Errors: there is one, and nobody saw its end: `assume` must say how long it was on.
[[nodiscard]] Result<std::optional<OpenLight>> close_open_light(JournalFacts& facts, Guard* guard,
                                                                const Assume& assume);

/// The first step whose light is not complete; the number of steps if there is none.
[[nodiscard]] std::size_t next_light(const JournalFacts& facts, const Script& script);

/// Errors: no step of the script, though the journal speaks of it (another job).
[[nodiscard]] Result<Recovery> recovery_of(const JournalFacts& facts, const Script& script,
                                           const machine::Printer& printer, const Standing& standing);

/// Whether so little light is missing that none need be given.
[[nodiscard]] bool is_enough(double lit_s, double planned_s);

}  // namespace pliant::host
