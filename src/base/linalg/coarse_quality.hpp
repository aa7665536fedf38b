// When a coarse level that was made for an earlier matrix no longer pays.
#pragma once

#include <cmath>

namespace pliant::linalg {

/// What conjugate gradients have gained with an up-to-date coarse level.
class CoarseQuality {
public:
    CoarseQuality() = default;
    explicit CoarseQuality(double usual_gain) : usual_gain_(usual_gain) {}
    [[nodiscard]] double usual_gain() const { return usual_gain_; }

    /// An up-to-date level reduced the squared error from `begun` to `now` in `iterations`.
    void learn(int iterations, double begun, double now) { usual_gain_ = std::log(begun / now) / iterations; }

    /// True if a new coarse level would pay: a rotated one reduced the squared error from `begun` to `now`, and is to
    /// reduce it to `enough`.
    [[nodiscard]] bool is_outdated(int iterations, double begun, double now, double enough) const {
        if (iterations < iterations_to_judge) return false;
        const double gain = std::log(begun / now) / iterations, to_go = std::log(now / enough);
        return gain <= 0 || to_go / gain > to_go / usual_gain_ + price_of_coarse;
    }

private:
    /// Cost of making a coarse level, in iterations (measured), and the number of iterations after which its quality
    /// shows.
    static constexpr double price_of_coarse = 7;
    static constexpr int iterations_to_judge = 4;
    /// Reduction of the squared error per iteration, as a logarithm: four to five iterations per digit, until measured.
    double usual_gain_ = 1;
};

}  // namespace pliant::linalg
