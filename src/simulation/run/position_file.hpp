// The positions of a long program, on disk instead of in memory.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "base/core/vec3.hpp"
#include "simulation/run/node_positions.hpp"

namespace pliant::sim {

/// A file without a name in the folder for temporary files, as large as all steps together; the system keeps in memory
/// what is in use. It is gone when nothing refers to its positions any more.
class PositionFile {
public:
    /// Null where there is no place for it.
    [[nodiscard]] static std::unique_ptr<PositionFile> make(std::size_t steps, std::size_t nodes);

    /// Preconditions: step < steps; as many points as nodes.
    [[nodiscard]] NodePositions keep(std::size_t step, std::span<const Vec3> points);

private:
    class Mapping;
    PositionFile(std::shared_ptr<Mapping> mapping, std::size_t nodes);

    std::shared_ptr<Mapping> mapping_;
    std::size_t nodes_;
};

}  // namespace pliant::sim
