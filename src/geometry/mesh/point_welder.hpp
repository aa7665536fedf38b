// Gives points at exactly the same place one index.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/core/vec3.hpp"

namespace pliant::mesh {

/// A hash table of its own: a node per place, as the standard one keeps, costs twice the time of reading a large file.
class PointWelder {
public:
    /// The index of this place; a new one if no point was there yet. Precondition: p is finite.
    int add(const Vec3& p) {
        if (2 * (points_.size() + 1) > slots_.size()) grow();
        const Vec3 key{p.x + 0.0, p.y + 0.0, p.z + 0.0};  // -0 and 0 are the same place
        int& slot = slots_[slot_of(key)];
        if (slot < 0) {
            slot = static_cast<int>(points_.size());
            points_.push_back(key);
        }
        return slot;
    }
    /// The places, in the order in which they came; leaves the welder empty.
    [[nodiscard]] std::vector<Vec3> take() {
        slots_.clear();
        return std::exchange(points_, {});
    }

private:
    static std::size_t hash(const Vec3& p) {
        std::uint64_t h = 0;
        for (const double c : {p.x, p.y, p.z})
            h = (h ^ std::bit_cast<std::uint64_t>(c)) * 0x9e3779b97f4a7c15u, h ^= h >> 29;
        // Round numbers end in zeros: their differences are brought down from the upper bits.
        h = (h ^ (h >> 33)) * 0xff51afd7ed558ccdu;
        return static_cast<std::size_t>(h ^ (h >> 33));
    }
    /// Where the place is, or the free slot where it belongs.
    [[nodiscard]] std::size_t slot_of(const Vec3& p) const {
        const std::size_t mask = slots_.size() - 1;
        std::size_t s = hash(p) & mask;
        while (slots_[s] >= 0 && !(points_[static_cast<std::size_t>(slots_[s])] == p)) s = (s + 1) & mask;
        return s;
    }
    void grow() {
        slots_.assign(std::max<std::size_t>(64, 2 * slots_.size()), -1);
        for (std::size_t i = 0; i < points_.size(); ++i) slots_[slot_of(points_[i])] = static_cast<int>(i);
    }

    std::vector<int> slots_;  ///< indices of points, -1 where free; as many as a power of two, half of them free
    std::vector<Vec3> points_;
};

}  // namespace pliant::mesh
