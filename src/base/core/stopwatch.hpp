// Timing of pieces of work.
#pragma once

#include <chrono>
#include <utility>

namespace pliant {

class Stopwatch {
public:
    /// Seconds of wall time since construction or the last call.
    double read_s() {
        const auto now = std::chrono::steady_clock::now();
        return std::chrono::duration<double>(now - std::exchange(begin_, now)).count();
    }

private:
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace pliant
