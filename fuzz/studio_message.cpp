// WebSocket messages from a page to the studio.
#include "input.hpp"
#include "studio/requests/message.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    (void)pliant::studio::parse_message(as_text(data, size));
    return 0;
}
