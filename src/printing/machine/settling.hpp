// Magnet and fork take their time after they are switched: until then nothing may move that they hold, or that is in
// their way.
#pragma once

#include "base/core/error.hpp"
#include "printing/machine/gcode.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::machine {

/// Watches a program on its clock. The printer must outlive it.
class Settling {
public:
    explicit Settling(const Printer& printer) : printer_(&printer) {}

    /// A command that was carried out at `at_s`; only those that switch magnet or fork matter.
    void note(const Command& command, double at_s);
    /// Whether a move may begin at `start_s`.
    [[nodiscard]] Status check(const Position& from, const Position& to, double start_s) const;

private:
    const Printer* printer_;
    double magnet_ready_s_ = 0, fork_ready_s_ = 0;
};

}  // namespace pliant::machine
