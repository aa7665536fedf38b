/// @file
/// What a page draws of a robot: the studio's viewer, in a page of one's own.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pliant/base.hpp"
#include "pliant/simulation.hpp"

namespace pliant {

/// Surfaces of every material, cables, chambers, supports, obstacles and markers, as the viewer of web/src/viewer.ts
/// reads them: a head in JSON and arrays of numbers behind it. docs/reference/studio.md says what is in these packets.
/// Lengths in mm.
class PLIANT_API View {
public:
    /// Finds the surfaces.
    explicit View(const Model& model);
    /// Moves it; the other one is of no use afterwards.
    View(View&&) noexcept;
    /// Moves it; the other one is of no use afterwards.
    View& operator=(View&&) noexcept;
    ~View();

    /// Everything that does not move.
    [[nodiscard]] std::string scene() const;
    /// A state, with its fields.
    /// @throws Failure where the state is one of another model.
    [[nodiscard]] std::string frame(const State& state) const;
    /// Nodes that are anywhere, (nodes) m, as those of a ProgramStep; obstacles are where they are at `time`.
    /// @throws Failure where there are not as many as the model has, or one is not finite.
    [[nodiscard]] std::string frame(const std::vector<Point>& positions, double time) const;

private:
    struct Work;
    std::unique_ptr<Work> work_;
};

}  // namespace pliant
