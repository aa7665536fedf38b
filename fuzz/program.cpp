// Programs of G-code from anywhere: checked against the tower, and wherever they stand, ended safely.
#include "input.hpp"
#include "plan/check.hpp"
#include "plan/safe_stop.hpp"

namespace {

const pliant::machine::Printer& printer() {
    static const auto loaded = pliant::machine::load_printer("examples/printers/tower.toml");
    if (!loaded) __builtin_trap();  // run from the root of the repository
    return *loaded;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text(as_text(data, size));
    const auto state = pliant::plan::replay_gcode(text, printer(), 1000000);
    if (!state) return 0;
    const std::string end = text + "\n" + pliant::plan::cancel_program(*state, printer());
    if (!pliant::plan::check_gcode(end, printer())) __builtin_trap();
    return 0;
}
