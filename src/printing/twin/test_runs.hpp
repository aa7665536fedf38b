// Simple pictures for tests.
#pragma once

#include "printing/twin/runs.hpp"

namespace pliant::twin::test {

/// A rectangle of equal pixels.
inline Runs block(int row, int end_row, int begin, int end, int value = 255) {
    Runs runs;
    for (; row < end_row; ++row) runs.push_back({row, begin, end, static_cast<std::uint16_t>(value)});
    return runs;
}

}  // namespace pliant::twin::test
