// Compiled once for each instruction set; the one that the machine has is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simulation/elements/mass_kernel.cpp"
#include "simulation/elements/mass_kernel.hpp"

#include <hwy/foreach_target.h>
// After foreach_target, as it asks.
#include <hwy/highway.h>

#include "simulation/elements/element_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pliant::sim::HWY_NAMESPACE {

template <int nodes>
void momentum_of(const TetBatch& batch, const double* masses, const double* shares, const double* v, double* momenta) {
    const Tag d;
    constexpr int N = static_cast<int>(hn::MaxLanes(Tag()));
    for (int part = 0; part < batch_lanes; part += N) {
        V velocities[nodes][3];
        load_positions<nodes>(batch, v, part, velocities);
        const V mass = hn::Load(d, masses + part);
        for (int a = 0; a < nodes; ++a) {
            V sum[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
            for (int b = 0; b < nodes; ++b) {
                const V share = set(shares[a * nodes + b]);
                for (int k = 0; k < 3; ++k) sum[k] = hn::MulAdd(share, velocities[b][k], sum[k]);
            }
            for (int k = 0; k < 3; ++k) hn::Store(hn::Mul(mass, sum[k]), d, momenta + (3 * a + k) * batch_lanes + part);
        }
    }
}

void momentum(const TetBatch& batch, const double* masses, const double* shares, const double* v, double* momenta) {
    if (batch.nodes_per_tet == 4)
        momentum_of<4>(batch, masses, shares, v, momenta);
    else
        momentum_of<10>(batch, masses, shares, v, momenta);
}

}  // namespace pliant::sim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pliant::sim {

HWY_EXPORT(momentum);

void batch_momentum(const TetBatch& batch, const double* masses, const double* shares, const double* v,
                    double* momenta) {
    HWY_DYNAMIC_DISPATCH(momentum)(batch, masses, shares, v, momenta);
}

}  // namespace pliant::sim
#endif
