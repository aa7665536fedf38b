// Short words from command lines and journals: faults of the virtual printer, emergency lines, states of the machine.
#include <string>

#include "input.hpp"
#include "printing/host/journal_facts.hpp"
#include "printing/twin/fault.hpp"
#include "printing/wire/emergency_line.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view word = as_text(data, size);
    const auto fault = pliant::twin::parse_fault(word);
    if (fault && fault->n < 1) __builtin_trap();
    (void)pliant::host::parse_emergency_line(word);
    (void)pliant::host::read_state(word);
    return 0;
}
