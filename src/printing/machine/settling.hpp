// Magnet and fork need time to switch: until then nothing that they hold, or that is in their way, may move.
#pragma once

#include "base/core/error.hpp"
#include "printing/machine/gcode.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::machine {

/// Follows a program on its clock. The printer must outlive it.
class Settling {
public:
    explicit Settling(const Printer& printer) : printer_(&printer) {}

    /// Records a command that was carried out at `at_s`; only those that switch magnet or fork matter.
    void note(const Command& command, double at_s);
    /// Error if a move must not begin at `start_s`.
    [[nodiscard]] Status check(const Position& from, const Position& to, double start_s) const;

private:
    const Printer* printer_;
    double magnet_ready_s_ = 0, fork_ready_s_ = 0;
};

}  // namespace pliant::machine
