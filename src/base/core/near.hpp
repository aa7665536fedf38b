// Numbers in tests: a measured one against an expected one, within a tolerance that the line states.
//
//   CHECK(measured == near(expected, {.relative = 1e-6}));
//   CHECK(measured == near(0, {.absolute = 1e-9}));  // where the quantity's own scale is known: metres, newtons
//
// doctest::Approx is not used: it adds 1 to its scale, so that 0.0 equals Approx(1.9e-6), and its default tolerance is
// invisible in the test. tools/check_tests reports any use of it.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace pliant {

/// The allowed deviation: `relative` as a fraction of the expected number, `absolute` in its unit; the larger of the
/// two applies. If both are 0, the numbers must be equal.
struct Tolerance {
    double relative = 0;
    double absolute = 0;
};

class Near {
public:
    Near(double expected, const Tolerance& tolerance)
        : expected_(expected), allowed_(std::max(tolerance.relative * std::abs(expected), tolerance.absolute)) {}

    /// NaN equals nothing; an infinity only itself.
    friend bool operator==(double measured, const Near& wanted) {
        wanted.measured_ = measured;
        if (std::isinf(measured) || std::isinf(wanted.expected_)) return measured == wanted.expected_;
        return std::abs(measured - wanted.expected_) <= wanted.allowed_;
    }

    /// What doctest prints beside the measured number.
    friend doctest::String toString(const Near& wanted) {
        char text[160];
        std::snprintf(text, sizeof text, "near %.10g (measured %.10g, off by %.3g, allowed %.3g)", wanted.expected_,
                      wanted.measured_, std::abs(wanted.measured_ - wanted.expected_), wanted.allowed_);
        return text;
    }

private:
    double expected_;
    double allowed_;
    mutable double measured_ = std::nan("");  // for toString only: the last number compared with this one
};

/// Requires a tolerance of at least 0; there is none by default.
inline Near near(double expected, const Tolerance& tolerance) {
    return {expected, tolerance};
}

}  // namespace pliant
