// Continuous collision detection: how far two features may move along straight lines before they come too close.
#pragma once

#include "simulation/contact/distance.hpp"

namespace pliant::sim::contact {

/// Additive CCD (Li, Kaufman and Jiang 2021, "Codimensional Incremental Potential Contact", algorithm 1): a step t in
/// [0, limit] up to which the distance at x + t dx stays at or above `keep` (0 < keep < 1) times that at x. It is
/// `limit` if nothing obstructs, else the step at which the distance has fallen to nearly `keep` of its value; 0 if x
/// already touches. Conservative: it may stop early, never late. `radius_m`: of a sphere about the point of
/// point_triangle, from whose surface the distance is measured.
[[nodiscard]] double largest_step(Features features, const Stencil& x, const Stencil& dx, double keep, double limit,
                                  double radius_m = 0);

/// The same with a limit to the number of distances that are computed; not ended: a lower bound.
struct Advance {
    double step = 0;
    bool ended = false;
};
[[nodiscard]] Advance advance(Features features, const Stencil& x, const Stencil& dx, double keep, double limit,
                              int most_looks, double radius_m = 0);

}  // namespace pliant::sim::contact
