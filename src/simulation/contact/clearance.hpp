// Distances between surfaces at one state, region by region. For nearby states, the relative motion of the regions
// proves that nothing touches, at a tenth of the cost of a proximity search.
//
// Two points a distance r apart cannot meet while their relative displacement is less than r. Between two regions, the
// bound on it is the largest difference of their points' displacements; if that is too large because both have rotated,
// the displacements after undoing that rotation, which changes no distance.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "simulation/contact/regions.hpp"

namespace pliant::sim::contact {

class Clearance {
public:
    struct Side {
        const Surface* surface;  ///< used by the constructor only
        std::shared_ptr<const Regions> regions;
    };
    /// Indices of two sides whose surfaces may touch; the same index twice for self-contact.
    using Meeting = std::pair<std::size_t, std::size_t>;

    /// At the state `x`, (3 nodes) metres. All features of `meetings` that are never offered must be at least `seen_m`
    /// apart, and all features more than their reach apart; the reach is at most `reach_m` < seen_m.
    Clearance(std::span<const Side> sides, std::span<const Meeting> meetings, std::span<const double> x, double seen_m,
              double reach_m);

    /// Adds two features of meeting `m`, by their nodes, that are `apart_m` < seen_m apart and interact when closer
    /// than `reach_m`.
    void offer(std::size_t m, std::span<const int> first, std::span<const int> second, double apart_m, double reach_m);

    /// True only if, anywhere between `x` and x + dx, nothing comes within its reach, nor to a tenth of any distance
    /// that it had on the way. `dx` empty: at x.
    [[nodiscard]] bool holds(std::span<const double> x, std::span<const double> dx) const;

private:
    struct Pair {
        std::size_t first, second;  ///< regions
        double room_m;              ///< largest relative displacement allowed
    };
    struct Cover {
        Meeting sides;
        std::vector<Pair> near;  ///< leaves, ascending
        std::vector<Pair> far;
    };
    struct Ball {
        Eigen::Vector3d centre;
        double radius_m;
    };
    struct Reference {
        std::shared_ptr<const Regions> regions;
        std::vector<Bounds> boxes;  ///< (regions) of their triangles
        std::vector<Ball> balls;    ///< (regions) of the points of leaves
    };
    /// A leaf approximated as a rigid body at both ends of a motion: p -> rotation (p - centre) + to, and the error for
    /// its points.
    struct Turned {
        Eigen::Matrix3d rotation;
        std::array<Eigen::Vector3d, 2> to;
        std::array<double, 2> off_m;
    };
    struct Motion {
        std::vector<Bounds> displacement;  ///< (regions)
        std::vector<int> place;            ///< (regions) index of a leaf in `turned`, -1: not computed
        std::deque<Turned> turned;         ///< a deque, so that entries keep their address
    };
    class Look;

    void add_pairs(Cover& cover, std::size_t a, std::size_t b) const;
    [[nodiscard]] bool halve_first(const Cover& cover, std::size_t a, std::size_t b) const;
    [[nodiscard]] double gap(const Cover& cover, std::size_t a, std::size_t b) const;

    std::vector<double> x_;
    double seen_m_, reach_m_;
    std::vector<Reference> sides_;
    std::vector<Cover> covers_;
};

}  // namespace pliant::sim::contact
