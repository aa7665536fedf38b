// The virtual printer receiving arbitrary bytes, for an hour of its own time.
#include "printing/twin/twin.hpp"

#include <algorithm>

#include "input.hpp"
#include "tower.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    pliant::twin::Twin twin(tower());
    for (std::size_t at = 0; at < size; at += 64) {
        twin.receive(as_text(data + at, std::min<std::size_t>(64, size - at)));
        twin.advance_to(twin.now() + 10);
        (void)twin.take_output();
    }
    twin.advance_to(twin.now() + 3600);
    return 0;
}
