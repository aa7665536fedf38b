// Gives points at exactly the same place one index.
#pragma once

#include <bit>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/vec3.hpp"

namespace pliant::mesh {

class PointWelder {
public:
    /// The index of this place; a new one if no point was there yet. Precondition: p is finite.
    int add(const Vec3& p) {
        const Vec3 key{p.x + 0.0, p.y + 0.0, p.z + 0.0};  // -0 and 0 are the same place
        const auto [entry, fresh] = index_.try_emplace(key, static_cast<int>(points_.size()));
        if (fresh) points_.push_back(key);
        return entry->second;
    }
    /// The places, in the order in which they came; leaves the welder empty.
    [[nodiscard]] std::vector<Vec3> take() {
        index_.clear();
        return std::exchange(points_, {});
    }

private:
    struct Hash {
        std::size_t operator()(const Vec3& p) const {
            std::uint64_t h = 0;
            for (const double c : {p.x, p.y, p.z})
                h = (h ^ std::bit_cast<std::uint64_t>(c)) * 0x9e3779b97f4a7c15u, h ^= h >> 29;
            return static_cast<std::size_t>(h);
        }
    };
    std::unordered_map<Vec3, int, Hash> index_;
    std::vector<Vec3> points_;
};

}  // namespace pliant::mesh
