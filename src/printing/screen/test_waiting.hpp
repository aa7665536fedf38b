// Waiting for what another process does, for tests.
#pragma once

#include <chrono>
#include <functional>
#include <thread>

namespace pliant::host::test {

/// Waits for a condition; the test's own time limit ends it otherwise.
inline bool becomes_true(const std::function<bool()>& condition) {
    for (int i = 0; i < 2000; ++i) {
        if (condition()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
}

}  // namespace pliant::host::test
