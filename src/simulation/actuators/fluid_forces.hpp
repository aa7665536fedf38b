// Buoyancy and drag on the skin of bodies and objects in a fluid.
//
// Buoyancy is the gradient of the energy of the fluid that is displaced, E = rho g * integral of the depth over the
// part of the body below the level. For a closed skin that is
//     E = rho g * integral over the skin of depth^2/2 (down . n) dA,    depth below zero counting as zero,
// so that it needs no volume, and its force is the pressure on the skin.
//
// Drag on a piece of skin of area A and normal n that moves with u through the fluid is
//     rho/2 A (c_n |u_n| u_n + c_t |u_t| u_t),    u_n along n and u_t across it,
// on both sides of a body: a sphere has the coefficient of drag c_n, a thin plate across its way 2 c_n. Areas and
// normals are those at the start of a step, so that drag in a step is the gradient of a convex potential, rho/6 A (c_n
// |u_n|^3 + c_t |u_t|^3) over the rate of the velocity: it takes energy out of what moves through a fluid at rest,
// however long the step.
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
    /// `skin`: triangles of contact's nodes, seen from outside counter-clockwise.
    FluidForces(const Fluid& fluid, std::vector<std::array<int, 3>> skin) : fluid_(fluid), skin_(std::move(skin)) {}

    [[nodiscard]] const std::vector<std::array<int, 3>>& skin() const { return skin_; }
    [[nodiscard]] bool drags() const { return fluid_.drag_normal > 0 || fluid_.drag_tangential > 0; }

    using Blocks = std::function<void(int, int, const linalg::Matrix3&)>;

    /// J; x (3 nodes), gravity m/s^2.
    [[nodiscard]] double buoyancy_energy(std::span<const double> x, const linalg::Vector3& gravity) const;
    /// forces (3 nodes) += gradient of the energy.
    void add_buoyancy(std::span<const double> x, const linalg::Vector3& gravity, std::span<double> forces) const;
    /// Every 3 x 3 block of every triangle; `project`: each triangle without negative eigenvalues.
    void visit_buoyancy(std::span<const double> x, const linalg::Vector3& gravity, bool project,
                        const Blocks& visit) const;

    /// Of a step that begins at `start`: velocities v (3 nodes), which change with positions by `rate`.
    struct Motion {
        std::span<const double> start, v;
        double rate;
        linalg::Vector3 gravity;  ///< where the level is
    };
    [[nodiscard]] double drag_energy(const Motion& motion) const;
    void add_drag(const Motion& motion, std::span<double> forces) const;
    void visit_drag(const Motion& motion, const Blocks& visit) const;

private:
    struct Piece;
    [[nodiscard]] Piece piece(const std::array<int, 3>& triangle, const Motion& motion) const;

    Fluid fluid_;
    std::vector<std::array<int, 3>> skin_;
};

}  // namespace pliant::sim
