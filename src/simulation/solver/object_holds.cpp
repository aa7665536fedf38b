#include "simulation/solver/object_holds.hpp"

#include "base/linalg/vectors.hpp"

namespace pliant::sim {
namespace {

/// Of the force over the size of an object: with a third, 16 hanging chains of one to three objects took fewer
/// iterations than with 0.1 or 1.
constexpr double hold_share = 0.3;

}  // namespace

void add_object_holds(const Equilibrium& system, const State& state, const Controls& controls,
                      const TangentLayout& layout, std::span<double> values) {
    if (system.objects().empty() || (controls.inertia && !controls.inertia->is_tether())) return;
    const Evaluation now = system.evaluate(state, controls);
    if (!now.possible()) return;
    for (const AffineBody& object : system.objects()) {
        double force_N = 0;
        for (const int node : object.nodes()) force_N += now.out_of_balance.segment<3>(3 * Eigen::Index{node}).norm();
        const double mean_N = force_N / static_cast<double>(object.nodes().size());
        object.add_hold(hold_share * mean_N / object.size(linalg::view(state.x)), system.model().free_index(),
                        layout.pattern, values);
    }
}

}  // namespace pliant::sim
