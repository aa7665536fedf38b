// Buoyancy and drag on the skin of bodies and objects in a fluid.
//
// Buoyancy is the gradient of the energy of the displaced fluid, E = rho g * integral of the depth over the part of the
// body below the level. For a closed skin this equals
//     E = rho g * integral over the skin of depth^2/2 (down . n) dA,    with depth = 0 above the level,
// which needs no volume, and its force is the pressure on the skin. Mouths of chambers that a support closes are holes
// in the skin: caps close them, so that the energy is that of a closed skin, but the fluid presses on the support there
// and not on the robot. The rest of the force is along the support and on what it holds.
//
// Drag on a piece of skin of area A and normal n that moves with velocity u through the fluid is
//     rho/2 A (c_n |u_n| u_n + c_t |u_t| u_t),    u_n along n and u_t tangential,
// on both sides of a body: a sphere has the drag coefficient c_n, a thin plate across the flow 2 c_n. Areas and normals
// are those at the start of a step, so that drag in a step is the gradient of a convex potential, rho/6 A (c_n |u_n|^3
// + c_t |u_t|^3) divided by the rate of the velocity: it dissipates energy for any step length.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "base/linalg/small.hpp"
#include "simulation/parts/description.hpp"

namespace pliant::sim {

class FluidForces {
public:
    /// `skin`: triangles of contact nodes, counter-clockwise seen from outside.
    FluidForces(const Fluid& fluid, std::vector<std::array<int, 3>> skin);

    /// The skin, and then the caps of its holes.
    [[nodiscard]] const std::vector<std::array<int, 3>>& closed_skin() const { return closed_skin_; }
    [[nodiscard]] bool drags() const { return fluid_.drag_normal > 0 || fluid_.drag_tangential > 0; }

    using Blocks = std::function<void(int, int, const linalg::Matrix3&)>;

    /// The level and the weight of the fluid: which way is down does not depend on how much of gravity acts.
    struct Gravity {
        linalg::Vector3 full_m_s2 = linalg::Vector3::Zero();
        double share = 1;  ///< of it that acts; may be 0 or negative
    };
    /// Energy, J; x (3 nodes).
    [[nodiscard]] double buoyancy_energy(std::span<const double> x, const Gravity& gravity) const;
    /// forces (3 nodes) += gradient of the energy, less the pressure on caps.
    void add_buoyancy(std::span<const double> x, const Gravity& gravity, std::span<double> forces) const;
    /// Visits the 3 x 3 blocks of each triangle; `project`: each triangle without negative eigenvalues.
    void visit_buoyancy(std::span<const double> x, const Gravity& gravity, bool project, const Blocks& visit) const;

    /// Motion in a step that begins at `start`: velocities v (3 nodes), dv/dx = `rate`.
    struct Motion {
        std::span<const double> start, v;
        double rate;
        Gravity gravity;  ///< its direction is that of the level; drag acts without its weight, too
    };
    [[nodiscard]] double drag_energy(const Motion& motion) const;
    void add_drag(const Motion& motion, std::span<double> forces) const;
    void visit_drag(const Motion& motion, const Blocks& visit) const;

private:
    struct Piece;
    [[nodiscard]] Piece piece(const std::array<int, 3>& triangle, const Motion& motion) const;

    [[nodiscard]] std::span<const std::array<int, 3>> skin() const {
        return std::span(closed_skin_).first(closed_skin_.size() - cap_count_);
    }

    Fluid fluid_;
    std::vector<std::array<int, 3>> closed_skin_;
    std::size_t cap_count_ = 0;
};

}  // namespace pliant::sim
