// How far apart the surfaces are at one state, region by region: for states near it, a look at how the regions have
// moved against each other tells that nothing touches, at a tenth of the cost of a search for what is near.
//
// Two points that are r apart do not meet while one moves less than r against the other. Between two regions the bound
// on that is the largest difference of their points' displacements; where it is too large because both have turned,
// the displacements after a rotation that takes them back, which changes no distance.
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
        const Surface* surface;  ///< looked at by the constructor only
        std::shared_ptr<const Regions> regions;
    };
    /// The two sides, by index, whose surfaces may touch; the same one twice for one that may touch itself.
    using Meeting = std::pair<std::size_t, std::size_t>;

    /// Of the state `x`, (3 nodes) metres, in which features of `meetings` that are offered by none are at least
    /// `seen_m` apart, and all are more than their reach apart, which is at most `reach_m` < seen_m.
    Clearance(std::span<const Side> sides, std::span<const Meeting> meetings, std::span<const double> x, double seen_m,
              double reach_m);

    /// Two features of meeting `m`, by their nodes, that are `apart_m` < seen_m apart and act on each other when nearer
    /// than `reach_m`.
    void offer(std::size_t m, std::span<const int> first, std::span<const int> second, double apart_m, double reach_m);

    /// True only if nothing comes within its reach, nor to a tenth of any distance that it had on the way, anywhere
    /// between `x` and x + dx. `dx` empty: at x.
    [[nodiscard]] bool holds(std::span<const double> x, std::span<const double> dx) const;

private:
    struct Pair {
        std::size_t first, second;  ///< regions
        double room_m;              ///< how far they may move against each other
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
    /// A leaf as a rigid body at both ends of a motion: p -> rotation (p - centre) + to, and how far its points are
    /// off.
    struct Turned {
        Eigen::Matrix3d rotation;
        std::array<Eigen::Vector3d, 2> to;
        std::array<double, 2> off_m;
    };
    struct Motion {
        std::vector<Bounds> displacement;  ///< (regions)
        std::vector<int> place;            ///< (regions) of a leaf among the turned, -1: not asked for
        std::deque<Turned> turned;         ///< stay where they are when more come
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
