// The printer used by targets.
#pragma once

#include "printing/machine/printer.hpp"

inline const pliant::machine::Printer& tower() {
    static const auto loaded = pliant::machine::load_printer("examples/printers/tower.toml");
    if (!loaded) __builtin_trap();  // must run from the root of the repository
    return *loaded;
}
