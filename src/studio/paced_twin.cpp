#include "studio/paced_twin.hpp"

#include <algorithm>
#include <thread>

namespace pliant::studio {
namespace {

constexpr double most_at_once_s = 0.05;  // of wall time: an emergency stop must not wait longer

/// The host's end of the wire. Waiting moves the twin's clock on.
class TwinWire final : public host::Wire {
public:
    TwinWire(twin::Twin& twin, Pace& pace) : twin_(twin), pace_(pace) {}
    [[nodiscard]] Status write(std::string_view bytes) override {
        twin_.receive(bytes);
        return {};
    }
    [[nodiscard]] Result<std::string> read(double timeout_s) override {
        const double end_s = twin_.now() + std::min(timeout_s, most_at_once_s * pace_.speed());
        for (;;) {
            if (std::string said = twin_.take_output(); !said.empty()) return said;
            const auto next = twin_.next_event();
            if (!next || *next > end_s) break;
            go(*next);
        }
        go(end_s);
        return twin_.take_output();
    }
    [[nodiscard]] Status reset() override {
        twin_.reset();
        return {};
    }

private:
    void go(double to_s) {
        twin_.advance_to(to_s);
        pace_.wait_for(twin_.now());
    }
    twin::Twin& twin_;
    Pace& pace_;
};

}  // namespace

void Pace::wait_for(double virtual_s) {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double> owed((virtual_s - last_virtual_s_) / speed_);
    last_virtual_s_ = virtual_s;
    // Time that the program itself has taken is not made up for by running faster later.
    due_ = std::max(due_, now - std::chrono::milliseconds(100)) +
           std::chrono::duration_cast<std::chrono::steady_clock::duration>(owed);
    while (!free_ && std::chrono::steady_clock::now() < due_) {
        const auto rest = due_ - std::chrono::steady_clock::now();
        std::this_thread::sleep_for(std::min<std::chrono::steady_clock::duration>(rest, std::chrono::milliseconds(20)));
    }
}

PacedTwin::PacedTwin(const machine::Printer& printer, double speed)
    : twin_(printer), pace_(speed), projector_(twin_), clock_(twin_, pace_) {}

std::unique_ptr<host::Wire> PacedTwin::wire() {
    return std::make_unique<TwinWire>(twin_, pace_);
}

Status PacedTwin::Projector::show(const job::Image& image) {
    twin_.light_on(image);
    return {};
}

Status PacedTwin::Projector::black() {
    twin_.light_off();
    return {};
}

void PacedTwin::Clock::sleep(double seconds) {
    twin_.advance_to(twin_.now() + seconds);
    pace_.wait_for(twin_.now());
}

}  // namespace pliant::studio
