// A job's G-code parsed by the host, and the start times of its steps.
#include "printing/host/script.hpp"

#include "input.hpp"
#include "tower.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace pliant::host;
    const auto script = read_script(as_text(data, size));
    if (!script) return 0;
    const auto times = script_times(*script, tower());
    if (!times) return 0;
    if (times->size() != script->steps.size() + 1) __builtin_trap();
    for (std::size_t i = 1; i < times->size(); ++i) {
        if (!((*times)[i] >= (*times)[i - 1])) __builtin_trap();
    }
    (void)state_before(*script, tower(), script->steps.size() / 2);
    return 0;
}
