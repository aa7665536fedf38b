#include "printing/operate/board.hpp"

#include <string_view>

#include "printing/wire/serial.hpp"
#include "printing/wire/steady_clock.hpp"

namespace pliant::operate {
namespace {

/// Reads until `wanted` is received, or nothing more has come for `silence_s`.
Status listen(host::SerialWire& wire, std::string_view wanted, double silence_s, std::string& heard) {
    constexpr double most_s = 20;
    const host::SteadyClock clock;
    const double begin_s = clock.now();
    std::string recent = "\n";
    while (clock.now() - begin_s < most_s) {
        const Result<std::string> bytes = wire.read(silence_s);
        if (!bytes) return tl::unexpected(bytes.error());
        if (bytes->empty()) return {};
        heard += *bytes;
        recent += *bytes;
        if (recent.find(fmt::format("\n{}", wanted)) != std::string::npos) return {};
    }
    return {};
}

}  // namespace

Result<std::string> ask_board(const std::string& port, int baud_rate) {
    Result<host::SerialWire> wire = host::SerialWire::open(port, baud_rate);
    if (!wire) return tl::unexpected(wire.error());
    std::string heard;
    constexpr double boot_s = 3;  // of silence; a board that opening its port has reset starts within this time
    constexpr double answer_s = 2;
    if (Status status = listen(*wire, "start", boot_s, heard); !status) return tl::unexpected(status.error());
    std::string ignored;
    if (Status status = listen(*wire, "nothing more", 0.3, ignored); !status) return tl::unexpected(status.error());
    heard.clear();
    for (const char* query : {"M115\n", "M503\n", "M211\n", "M119\n", "M113\n"}) {
        if (Status status = wire->write(query); !status) return tl::unexpected(status.error());
        if (Status status = listen(*wire, "ok", answer_s, heard); !status) return tl::unexpected(status.error());
    }
    return heard;
}

}  // namespace pliant::operate
