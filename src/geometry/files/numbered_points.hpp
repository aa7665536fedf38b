// The points of a file with arbitrary point numbers: maps each number to an index in a list.
#pragma once

#include <cstdint>
#include <limits>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/core/vec3.hpp"

namespace pliant::mesh {

class NumberedPoints {
public:
    void reserve(std::size_t count) { points_.reserve(count); }

    /// False if the number is already taken.
    [[nodiscard]] bool add(std::int64_t number, const Vec3& point) {
        const auto place = static_cast<std::int64_t>(points_.size());
        if (points_.empty()) first_ = number;
        const bool in_row = from_first(number) == place && scattered_.empty();
        if (!in_row && scattered_.empty()) scatter();
        if (!in_row && !scattered_.try_emplace(number, place).second) return false;
        points_.push_back(point);
        return true;
    }

    /// Index in the list, or -1.
    [[nodiscard]] std::int64_t find(std::int64_t number) const {
        if (scattered_.empty()) {
            const std::int64_t place = from_first(number);
            return place >= 0 && static_cast<std::uint64_t>(place) < points_.size() ? place : -1;
        }
        const auto found = scattered_.find(number);
        return found == scattered_.end() ? -1 : found->second;
    }

    [[nodiscard]] std::size_t size() const { return points_.size(); }
    /// The points in file order; leaves this object empty.
    [[nodiscard]] std::vector<Vec3> take() { return std::exchange(points_, {}); }

private:
    /// Distance from the first number; -1 where that is below zero or too large.
    [[nodiscard]] std::int64_t from_first(std::int64_t number) const {
        const std::uint64_t distance = static_cast<std::uint64_t>(number) - static_cast<std::uint64_t>(first_);
        return number < first_ || distance > std::numeric_limits<std::int64_t>::max()
                   ? -1
                   : static_cast<std::int64_t>(distance);
    }
    /// Consecutive numbers need no table; the first gap creates one.
    void scatter() {
        for (std::size_t i = 0; i < points_.size(); ++i)
            scattered_[first_ + static_cast<std::int64_t>(i)] = static_cast<std::int64_t>(i);
    }

    std::vector<Vec3> points_;
    std::int64_t first_ = 0;
    std::unordered_map<std::int64_t, std::int64_t> scattered_;  ///< empty while the numbers are consecutive
};

}  // namespace pliant::mesh
