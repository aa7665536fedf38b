// Stores the positions of a long program on disk instead of in memory.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "base/core/vec3.hpp"
#include "simulation/run/node_positions.hpp"

namespace pliant::sim {

/// An unnamed file in the temporary folder, large enough for all steps; the system caches what is in use. It is deleted
/// when nothing refers to its positions any more.
class PositionFile {
public:
    /// Null if there is no space for it.
    [[nodiscard]] static std::unique_ptr<PositionFile> make(std::size_t steps, std::size_t nodes);

    /// Stores the positions of a step. Preconditions: step < steps; as many points as nodes.
    [[nodiscard]] NodePositions keep(std::size_t step, std::span<const Vec3> points);

private:
    class Mapping;
    PositionFile(std::shared_ptr<Mapping> mapping, std::size_t nodes);

    std::shared_ptr<Mapping> mapping_;
    std::size_t nodes_;
};

}  // namespace pliant::sim
