// Energy, forces and stiffness of several tets at once, summed over their points, for any kind of law. Included once
// for each instruction set, like element_lanes-inl.hpp.
//
// A Point is constructed from a deformation gradient and a law: point.set_shape(F) computes J, point.set_law(law) the
// rest. point.add_energy(law, volume, sum) adds its energy to the sum, point.stress(law, volume) is P times the volume.
#if defined(PLIANT_SIM_ELEMENT_SUMS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef PLIANT_SIM_ELEMENT_SUMS_INL_HPP
#undef PLIANT_SIM_ELEMENT_SUMS_INL_HPP
#else
#define PLIANT_SIM_ELEMENT_SUMS_INL_HPP
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <limits>

#include "simulation/elements/element_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace pliant::sim::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// `forces`: as for batch_forces; null if only the energy is wanted.
template <class Point, int nodes, class Law>
BatchResult forces_of(const TetBatch& batch, const Law& law, const double* x, double* forces) {
    const Tag d;
    constexpr int N = static_cast<int>(hn::MaxLanes(Tag()));
    HWY_ALIGN double energies[batch_lanes] = {};
    double min_J = std::numeric_limits<double>::infinity();
    for (int part = 0; part < batch_lanes; part += N) {
        V positions[nodes][3];
        load_positions<nodes>(batch, x, part, positions);
        V sum[nodes][3];
        for (auto& row : sum) {
            for (V& entry : row) entry = hn::Zero(d);
        }
        V energy = hn::Zero(d);
        for (int q = 0; q < batch.points; ++q) {
            Point point;
            point.set_shape(deformation_gradient<nodes>(batch, q, part, positions));
            // Written so that a NaN counts as inside out.
            if (!hn::AllTrue(d, hn::Gt(point.J, hn::Zero(d)))) return {0, -1};
            min_J = std::min(min_J, hn::GetLane(hn::MinOfLanes(d, point.J)));
            point.set_law(law);
            const V volume = hn::Load(d, batch.volumes + q * batch_lanes + part);
            energy = point.add_energy(law, volume, energy);
            if (forces == nullptr) continue;
            const Matrix P = point.stress(law, volume);
            for (int a = 0; a < nodes; ++a) {
                const Vector f = times(P, gradient(batch, q, a, part));
                for (int k = 0; k < 3; ++k) sum[a][k] = hn::Add(sum[a][k], f.v[k]);
            }
        }
        hn::Store(energy, d, energies + part);
        for (int a = 0; forces != nullptr && a < nodes; ++a) {
            for (int k = 0; k < 3; ++k) hn::Store(sum[a][k], d, forces + (3 * a + k) * batch_lanes + part);
        }
    }
    BatchResult result{0, min_J};
    for (const double energy : energies) result.energy_J += energy;
    return result;
}

/// Stiffness blocks of each pair of nodes. A Form is constructed from a Point, its law and its volume; `Form::OfNode`
/// holds what it needs of a node, form.of_node(gradient) computes it, and form.add_pair(a, b, block) adds the
/// contribution of two nodes to their block, by columns.
template <class Point, class Form, int nodes, class Law>
void stiffness_of(const TetBatch& batch, const Law& law, const double* x, double* blocks) {
    const Tag d;
    constexpr int N = static_cast<int>(hn::MaxLanes(Tag()));
    for (int part = 0; part < batch_lanes; part += N) {
        V positions[nodes][3];
        load_positions<nodes>(batch, x, part, positions);
        for (int q = 0; q < batch.points; ++q) {
            Point point;
            point.set_shape(deformation_gradient<nodes>(batch, q, part, positions));
            point.set_law(law);
            const Form form(point, law, hn::Load(d, batch.volumes + q * batch_lanes + part));
            typename Form::OfNode node[nodes];
            for (int a = 0; a < nodes; ++a) node[a] = form.of_node(gradient(batch, q, a, part));
            double* out = blocks + part;
            for (int b = 0; b < nodes; ++b) {
                for (int a = 0; a <= b; ++a, out += 9 * batch_lanes) {
                    V block[3][3];
                    for (int k = 0; k < 9; ++k)
                        block[k / 3][k % 3] = q == 0 ? hn::Zero(d) : hn::Load(d, out + k * batch_lanes);
                    form.add_pair(node[a], node[b], block);
                    for (int k = 0; k < 9; ++k) hn::Store(block[k / 3][k % 3], d, out + k * batch_lanes);
                }
            }
        }
    }
}

}  // namespace pliant::sim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
