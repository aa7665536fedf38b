#include "studio/print/paced_twin.hpp"

#include <algorithm>
#include <thread>

namespace pliant::studio {
namespace {

constexpr double most_at_once_s = 0.05;  // of wall time: an emergency stop must not wait longer

/// The host's end of the wire. Waiting advances the twin's clock.
class TwinWire final : public host::Wire {
public:
    TwinWire(SharedTwin& shared, Pace& pace) : shared_(shared), pace_(pace) {}
    [[nodiscard]] Status write(std::string_view bytes) override {
        const std::lock_guard lock(shared_.mutex);
        shared_.twin.receive(bytes);
        return {};
    }
    [[nodiscard]] Result<std::string> read(double timeout_s) override {
        std::unique_lock lock(shared_.mutex);
        const double end_s = shared_.twin.now() + std::min(timeout_s, most_at_once_s * pace_.speed());
        for (;;) {
            if (std::string said = shared_.twin.take_output(); !said.empty()) return said;
            const auto next = shared_.twin.next_event();
            if (!next || *next > end_s) break;
            go(*next, lock);
        }
        go(end_s, lock);
        return shared_.twin.take_output();
    }
    [[nodiscard]] Status reset() override {
        const std::lock_guard lock(shared_.mutex);
        shared_.twin.reset();
        return {};
    }

private:
    void go(double to_s, std::unique_lock<std::mutex>& lock) {
        shared_.twin.advance_to(to_s);
        const double now_s = shared_.twin.now();
        lock.unlock();
        pace_.wait_for(now_s);
        lock.lock();
    }
    SharedTwin& shared_;
    Pace& pace_;
};

}  // namespace

void Pace::wait_for(double virtual_s) {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double> owed((virtual_s - last_virtual_s_) / speed_);
    last_virtual_s_ = virtual_s;
    // Time that the program itself has used is not made up for by running faster later.
    due_ = std::max(due_, now - std::chrono::milliseconds(100)) +
           std::chrono::duration_cast<std::chrono::steady_clock::duration>(owed);
    while (!free_ && std::chrono::steady_clock::now() < due_) {
        const auto rest = due_ - std::chrono::steady_clock::now();
        std::this_thread::sleep_for(std::min<std::chrono::steady_clock::duration>(rest, std::chrono::milliseconds(20)));
    }
}

PacedTwin::PacedTwin(const machine::Printer& printer, twin::Options options, double speed)
    : shared_(printer, std::move(options)), pace_(speed), projector_(shared_), clock_(shared_, pace_) {}

std::unique_ptr<host::Wire> PacedTwin::wire() {
    return std::make_unique<TwinWire>(shared_, pace_);
}

Status PacedTwin::Projector::show(const job::Image& image) {
    const std::lock_guard lock(shared_.mutex);
    shared_.twin.light_on(image);
    return {};
}

Status PacedTwin::Projector::black() {
    const std::lock_guard lock(shared_.mutex);
    shared_.twin.light_off();
    return {};
}

double PacedTwin::Clock::now() const {
    const std::lock_guard lock(shared_.mutex);
    return shared_.twin.now();
}

void PacedTwin::Clock::sleep(double seconds) {
    double now_s = 0;
    {
        const std::lock_guard lock(shared_.mutex);
        shared_.twin.advance_to(shared_.twin.now() + seconds);
        now_s = shared_.twin.now();
    }
    pace_.wait_for(now_s);
}

}  // namespace pliant::studio
