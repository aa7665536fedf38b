// The real clock.
#pragma once

#include <chrono>
#include <thread>

#include "printing/wire/devices.hpp"

namespace pliant::host {

class SteadyClock final : public Clock {
public:
    [[nodiscard]] double now() const override {
        return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
    }
    void sleep(double seconds) override {
        if (seconds > 0) std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
    }
};

}  // namespace pliant::host
