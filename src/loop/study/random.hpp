// Portable random numbers: the same on every machine.
#pragma once

#include <cstdint>

namespace pliant::study {

/// SplitMix64 (G. L. Steele, D. Lea, C. H. Flood, OOPSLA 2014): 64 random bits per call.
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    std::uint64_t next() {
        std::uint64_t z = state_ += 0x9e3779b97f4a7c15ULL;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
        return z ^ (z >> 31);
    }
    /// In [0, 1), 53 bits.
    double share() { return static_cast<double>(next() >> 11) / 9007199254740992.0; }
    /// In [0, n), for n up to 2^32; probabilities differ by at most 2^-32.
    std::uint64_t below(std::uint64_t n) { return ((next() >> 32) * n) >> 32; }

private:
    std::uint64_t state_;
};

}  // namespace pliant::study
