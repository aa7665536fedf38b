// Paces frames for panels without a frame clock of their own.
#pragma once

#include <algorithm>

#include "printing/wire/steady_clock.hpp"

namespace pliant::host {

class Pacer {
public:
    explicit Pacer(double frame_s) : frame_s_(frame_s) {}
    /// Waits until the next frame should start, so that it is on the panel one frame after the last.
    void wait() {
        clock_.sleep(last_s_ + frame_s_ - quickest_s_ - clock_.now());
        begun_s_ = clock_.now();
    }
    /// Call when the frame is on the panel: returns that time, from which the next one counts.
    double mark() {
        last_s_ = clock_.now();
        quickest_s_ = std::min(quickest_s_, last_s_ - begun_s_);
        return last_s_;
    }

private:
    double frame_s_;
    double last_s_ = 0;
    double begun_s_ = 0;
    double quickest_s_ = frame_s_;  ///< shortest time from start to display seen so far
    SteadyClock clock_;
};

}  // namespace pliant::host
