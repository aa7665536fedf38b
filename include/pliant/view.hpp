/// @file
/// Data for drawing a robot on a web page with the viewer of the studio.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pliant/base.hpp"
#include "pliant/simulation.hpp"

namespace pliant {

/// Surfaces of every material, cables, chambers, supports, obstacles and markers, in the format that the viewer in
/// web/src/viewer.ts reads: a JSON header followed by arrays of numbers. docs/reference/studio.md describes these
/// packets. Lengths in mm.
class PLIANT_API View {
public:
    /// Extracts the surfaces.
    explicit View(const Model& model);
    /// Moves; the moved-from view may only be assigned to or destroyed.
    View(View&&) noexcept;
    /// Moves; the moved-from view may only be assigned to or destroyed.
    View& operator=(View&&) noexcept;
    ~View();

    /// Everything that does not move.
    [[nodiscard]] std::string scene() const;
    /// A state with its fields.
    /// @throws Failure if the state belongs to another model.
    [[nodiscard]] std::string frame(const State& state) const;
    /// Arbitrary node positions, (nodes) m, such as those of a ProgramStep; obstacles are placed as at `time`.
    /// @throws Failure if the number of positions differs from that of the nodes, or one of them or the time is not
    /// finite.
    [[nodiscard]] std::string frame(const std::vector<Point>& positions, double time) const;

private:
    struct Work;
    std::unique_ptr<Work> work_;
};

}  // namespace pliant
