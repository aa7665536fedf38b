// Arbitrary G-code programs: checked against the tower, and ended safely from wherever they stop.
#include "input.hpp"
#include "printing/plan/check.hpp"
#include "printing/plan/safe_stop.hpp"
#include "tower.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text(as_text(data, size));
    const auto state = pliant::plan::replay_gcode(text, tower(), 1000000);
    if (!state) return 0;
    const std::string end = text + "\n" + pliant::plan::cancel_program(*state, tower());
    if (!pliant::plan::check_gcode(end, tower())) __builtin_trap();
    return 0;
}
