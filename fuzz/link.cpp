// A controller that sends anything at all: the host's link must terminate, with a reason if it fails.
#include "printing/wire/link.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "bytes.hpp"

namespace {

using namespace pliant;

class CountingClock final : public host::Clock {
public:
    [[nodiscard]] double now() const override { return now_s; }
    void sleep(double seconds) override { now_s += seconds; }
    double now_s = 0;
};

/// Delivers the input in pieces, some of them late, and then is silent. A `friendly` one first completes the
/// connection, which random input would never achieve.
class AnyWire final : public host::Wire {
public:
    AnyWire(Bytes bytes, CountingClock& clock, bool friendly) : bytes_(bytes), clock_(clock), friendly_(friendly) {}
    [[nodiscard]] Status write(std::string_view line) override {
        if (!friendly_) return {};
        const std::size_t echo = line.find("M118 E1 ");
        if (line.find("N2147483640") != line.npos) {
            said_ += "Error:Line Number is not Last Line Number+1, Last Line: 0\nResend: 1\nok\n";
            friendly_ = false;
        } else {
            said_ += echo == line.npos ? "ok\n" : "echo:" + std::string(line.substr(echo + 8)) + "ok\n";
        }
        return {};
    }
    [[nodiscard]] Result<std::string> read(double timeout_s) override {
        if (friendly_ || !said_.empty()) {
            if (said_.empty()) clock_.now_s += std::max(timeout_s, 1e-3);
            return std::exchange(said_, {});
        }
        const int length = bytes_.byte();
        if (length == 0) {
            clock_.now_s += std::max(timeout_s, 1e-3);
            return std::string();
        }
        clock_.now_s += 1e-3;
        return std::string(bytes_.text(static_cast<std::size_t>(length)));
    }

private:
    Bytes bytes_;
    CountingClock& clock_;
    bool friendly_;
    std::string said_;
};

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Bytes bytes(data, size);
    CountingClock clock;
    host::LinkOptions options;
    options.boot_s = 0.5;
    const bool asks_first = bytes.chance();
    AnyWire wire(bytes, clock, !asks_first);
    host::Link link(wire, clock, options);
    if (asks_first) (void)link.last_line();
    Status status = link.connect();
    if (status) (void)link.introduce();
    for (int i = 0; status && i < 6; ++i) status = link.send(i % 2 == 0 ? "G1 Z30" : "G1 Z20");
    if (status) (void)link.ask("M119");
    if (status) status = link.fence();
    if (!status && status.error().message.empty()) __builtin_trap();
    if (status) status = link.listen_for(1);
    link.stop({"M107 P1"});
    return 0;
}
