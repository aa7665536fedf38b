// Frames of a page's WebSocket: the first byte of each, then the length of its payload, then the payload.
#include <algorithm>
#include <cstdlib>

#include "input.hpp"
#include "studio/requests/frame_reader.hpp"
#include "studio/requests/message.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace pliant::studio;
    FrameReader reader;
    std::string_view rest = as_text(data, size);
    while (rest.size() >= 2) {
        const int bits = static_cast<unsigned char>(rest[0]);
        const std::size_t length = std::min<std::size_t>(static_cast<unsigned char>(rest[1]), rest.size() - 2);
        const FrameDeed deed = reader.take(bits, rest.substr(2, length));
        if (deed.bytes.size() > longest_message) std::abort();
        if (deed.kind == FrameDeed::Kind::close) break;
        if (deed.kind == FrameDeed::Kind::text) (void)parse_message(deed.bytes);
        rest.remove_prefix(2 + length);
    }
    return 0;
}
