#include "simulation/actuators/fluid_forces.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>

#include "base/core/disjoint_sets.hpp"
#include "base/linalg/dense.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/actuators/cross_matrix.hpp"
#include "simulation/actuators/wet_part.hpp"

namespace pliant::sim {
namespace {

using linalg::Matrix3;
using linalg::Matrix9;
using linalg::Vector3;
using Vector9 = Eigen::Matrix<double, 9, 1>;

/// The direction of gravity, and the specific weight of the fluid.
struct Weight {
    Vector3 down = Vector3::Zero();
    double N_m3 = 0;
    double level_m = 0;
    bool has_level = false;

    /// Negative above the level.
    [[nodiscard]] double depth(const Vector3& x) const { return level_m + down.dot(x); }
};

Weight weight_of(const Fluid& fluid, const FluidForces::Gravity& gravity) {
    const double g = gravity.full_m_s2.norm();
    Weight weight;
    if (g > 0)
        weight = {gravity.full_m_s2 / g, fluid.density_kg_m3 * gravity.share * g, fluid.level_m.value_or(0),
                  fluid.level_m.has_value()};
    return weight;
}

struct Corners {
    std::array<Vector3, 3> x;
    [[nodiscard]] Depths depths(const Weight& weight) const {
        return {weight.depth(x[0]), weight.depth(x[1]), weight.depth(x[2])};
    }
    [[nodiscard]] Vector3 middle() const { return (x[0] + x[1] + x[2]) / 3; }
    /// Twice the area, along the normal.
    [[nodiscard]] Vector3 twice_area() const { return (x[1] - x[0]).cross(x[2] - x[0]); }
};

Corners corners(std::span<const double> x, const std::array<int, 3>& t) {
    return {{linalg::view(x, t[0]), linalg::view(x, t[1]), linalg::view(x, t[2])}};
}

/// E = weight * s * Q, with s the projected area and Q the mean of depth^2/2.
struct Sunk {
    double s = 0, Q = 0;
    Vector9 ds = Vector9::Zero(), dQ = Vector9::Zero();
    Matrix9 ddQ = Matrix9::Zero();
};

Sunk sunk(const Weight& weight, const Corners& c) {
    Sunk sunk;
    sunk.s = 0.5 * weight.down.dot(c.twice_area());
    for (std::size_t i = 0; i < 3; ++i)
        sunk.ds.segment<3>(3 * static_cast<Eigen::Index>(i)) =
            0.5 * (c.x[(i + 1) % 3] - c.x[(i + 2) % 3]).cross(weight.down);
    const MeanSquare mean = mean_square(c.depths(weight), weight.has_level);
    sunk.Q = mean.value;
    for (Eigen::Index i = 0; i < 3; ++i) {
        sunk.dQ.segment<3>(3 * i) = mean.first[i] * weight.down;
        for (Eigen::Index j = 0; j < 3; ++j)
            sunk.ddQ.block<3, 3>(3 * i, 3 * j) = mean.second(i, j) * weight.down * weight.down.transpose();
    }
    return sunk;
}

Matrix9 second_change(const Weight& weight, const Sunk& sunk) {
    Matrix9 H = sunk.ds * sunk.dQ.transpose() + sunk.dQ * sunk.ds.transpose() + sunk.s * sunk.ddQ;
    const Matrix3 turn = 0.5 * sunk.Q * cross_matrix(weight.down);
    for (Eigen::Index i = 0; i < 3; ++i) {
        H.block<3, 3>(3 * i, 3 * ((i + 1) % 3)) -= turn;
        H.block<3, 3>(3 * i, 3 * ((i + 2) % 3)) += turn;
    }
    return weight.N_m3 * H;
}

/// Fans that close the holes of a skin: each from the lowest node of the hole's rim.
std::vector<std::array<int, 3>> caps_of(const std::vector<std::array<int, 3>>& skin) {
    std::map<std::pair<int, int>, int> uses;  // of each edge, from its lower node: in that direction less the other
    for (const auto& t : skin) {
        for (std::size_t i = 0; i < 3; ++i) {
            const int a = t[i], b = t[(i + 1) % 3];
            uses[std::minmax(a, b)] += a < b ? 1 : -1;
        }
    }
    std::erase_if(uses, [](const auto& edge) { return edge.second == 0; });
    int last = -1;
    for (const auto& [edge, count] : uses) last = std::max(last, edge.second);
    DisjointSets rims(static_cast<std::size_t>(last + 1));
    for (const auto& [edge, count] : uses) rims.join(edge.first, edge.second);
    std::vector<std::array<int, 3>> caps;
    for (const auto& [edge, count] : uses) {
        const int tip = rims.find(edge.first);
        if (edge.first == tip || edge.second == tip) continue;
        for (int k = 0; k < std::abs(count); ++k)
            caps.push_back(count > 0 ? std::array{edge.second, edge.first, tip}
                                     : std::array{edge.first, edge.second, tip});
    }
    return caps;
}

}  // namespace

FluidForces::FluidForces(const Fluid& fluid, std::vector<std::array<int, 3>> skin)
    : fluid_(fluid), closed_skin_(std::move(skin)) {
    const std::vector<std::array<int, 3>> caps = caps_of(closed_skin_);
    cap_count_ = caps.size();
    closed_skin_.insert(closed_skin_.end(), caps.begin(), caps.end());
}

double FluidForces::buoyancy_energy(std::span<const double> x, const Gravity& gravity) const {
    const Weight weight = weight_of(fluid_, gravity);
    double sum = 0;
    for (const auto& t : closed_skin_) {
        const Sunk part = sunk(weight, corners(x, t));
        sum += part.s * part.Q;
    }
    return weight.N_m3 * sum;
}

void FluidForces::add_buoyancy(std::span<const double> x, const Gravity& gravity, std::span<double> forces) const {
    const Weight weight = weight_of(fluid_, gravity);
    if (weight.N_m3 == 0) return;
    for (const auto& t : closed_skin_) {
        const Sunk part = sunk(weight, corners(x, t));
        const Vector9 force = weight.N_m3 * (part.Q * part.ds + part.s * part.dQ);
        for (std::size_t i = 0; i < 3; ++i) {
            Eigen::Map<Vector3> on(forces.data() + 3 * static_cast<std::size_t>(t[i]));
            on += force.segment<3>(3 * static_cast<Eigen::Index>(i));
        }
    }
    for (const auto& t : std::span(closed_skin_).last(cap_count_)) {
        const Corners c = corners(x, t);
        const MeanSquare mean = mean_square(c.depths(weight), weight.has_level);
        for (std::size_t i = 0; i < 3; ++i) {
            Eigen::Map<Vector3> on(forces.data() + 3 * static_cast<std::size_t>(t[i]));
            on -= 0.5 * weight.N_m3 * mean.first[static_cast<Eigen::Index>(i)] * c.twice_area();
        }
    }
}

void FluidForces::visit_buoyancy(std::span<const double> x, const Gravity& gravity, bool project,
                                 const Blocks& visit) const {
    const Weight weight = weight_of(fluid_, gravity);
    if (weight.N_m3 == 0) return;
    for (const auto& t : closed_skin_) {
        Matrix9 H = second_change(weight, sunk(weight, corners(x, t)));
        if (project) H = linalg::positive_part(0.5 * (H + H.transpose()));
        for (Eigen::Index i = 0; i < 3; ++i) {
            for (Eigen::Index j = 0; j < 3; ++j)
                visit(t[static_cast<std::size_t>(i)], t[static_cast<std::size_t>(j)], H.block<3, 3>(3 * i, 3 * j));
        }
    }
}

/// A triangle in the flow: rho/2 A of its submerged part, and its velocity along and across the normal.
struct FluidForces::Piece {
    double factor = 0;
    Vector3 normal = Vector3::Zero(), across = Vector3::Zero();
    double along = 0;
};

FluidForces::Piece FluidForces::piece(const std::array<int, 3>& triangle, const Motion& motion) const {
    const Corners begin = corners(motion.start, triangle), v = corners(motion.v, triangle);
    const Vector3 twice_area = begin.twice_area();
    const double size = twice_area.norm();
    Piece piece;
    if (!(size > 0)) return piece;
    const double wet = fluid_.level_m ? wet_share(begin.depths(weight_of(fluid_, motion.gravity))) : 1;
    const Vector3 u = v.middle() - linalg::vector(fluid_.current_m_s);
    piece.factor = 0.25 * fluid_.density_kg_m3 * size * wet;
    piece.normal = twice_area / size;
    piece.along = piece.normal.dot(u);
    piece.across = u - piece.along * piece.normal;
    return piece;
}

double FluidForces::drag_energy(const Motion& motion) const {
    double sum = 0;
    for (const auto& t : skin()) {
        const Piece p = piece(t, motion);
        sum += p.factor / 3 *
               (fluid_.drag_normal * std::pow(std::fabs(p.along), 3) +
                fluid_.drag_tangential * std::pow(p.across.norm(), 3));
    }
    return sum / motion.rate;
}

void FluidForces::add_drag(const Motion& motion, std::span<double> forces) const {
    for (const auto& t : skin()) {
        const Piece p = piece(t, motion);
        const Vector3 force = p.factor / 3 *
                              (fluid_.drag_normal * std::fabs(p.along) * p.along * p.normal +
                               fluid_.drag_tangential * p.across.norm() * p.across);
        for (const int node : t) {
            Eigen::Map<Vector3> on(forces.data() + 3 * static_cast<std::size_t>(node));
            on += force;
        }
    }
}

void FluidForces::visit_drag(const Motion& motion, const Blocks& visit) const {
    for (const auto& t : skin()) {
        const Piece p = piece(t, motion);
        const Matrix3 onto = p.normal * p.normal.transpose();
        const double speed = p.across.norm();
        Matrix3 H = 2 * fluid_.drag_normal * std::fabs(p.along) * onto;
        if (speed > 0)
            H += fluid_.drag_tangential *
                 (speed * (Matrix3::Identity() - onto) + p.across * p.across.transpose() / speed);
        H *= motion.rate * p.factor / 9;
        for (const int i : t) {
            for (const int j : t) visit(i, j, H);
        }
    }
}

}  // namespace pliant::sim
