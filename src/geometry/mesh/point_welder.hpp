// Merges points at exactly equal positions.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/core/vec3.hpp"

namespace pliant::mesh {

/// Has its own hash table: the standard one allocates a node per entry, which doubles the time to read a large file.
class PointWelder {
public:
    /// The index of this position; a new one if not seen before. Precondition: p is finite.
    int add(const Vec3& p) {
        if (2 * (points_.size() + 1) > slots_.size()) grow();
        const Vec3 key{p.x + 0.0, p.y + 0.0, p.z + 0.0};  // merges -0 and 0
        int& slot = slots_[slot_of(key)];
        if (slot < 0) {
            slot = static_cast<int>(points_.size());
            points_.push_back(key);
        }
        return slot;
    }
    /// The distinct positions, in order of first appearance; leaves the welder empty.
    [[nodiscard]] std::vector<Vec3> take() {
        slots_.clear();
        return std::exchange(points_, {});
    }

private:
    static std::size_t hash(const Vec3& p) {
        std::uint64_t h = 0;
        for (const double c : {p.x, p.y, p.z})
            h = (h ^ std::bit_cast<std::uint64_t>(c)) * 0x9e3779b97f4a7c15u, h ^= h >> 29;
        // Round numbers differ only in their upper bits: mix these into the lower ones.
        h = (h ^ (h >> 33)) * 0xff51afd7ed558ccdu;
        return static_cast<std::size_t>(h ^ (h >> 33));
    }
    /// The slot of the position, or the free slot where it belongs.
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

    std::vector<int> slots_;  ///< indices of points, -1 if free; the size is a power of two, at least half of it free
    std::vector<Vec3> points_;
};

}  // namespace pliant::mesh
