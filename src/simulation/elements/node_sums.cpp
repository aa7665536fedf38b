// Compiled once for each instruction set; the one that the machine has is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simulation/elements/node_sums.cpp"
#include "simulation/elements/node_sums.hpp"

#include <hwy/foreach_target.h>
// After foreach_target, as it asks.
#include <hwy/highway.h>

#include <algorithm>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace pliant::sim::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// list (places, 4) += forces (nodes_per_tet, 3, lanes), transposed so that the three components of a node are
/// adjacent.
void add_to_list(const double* forces, const std::uint16_t* place, std::size_t nodes_per_tet, double* list) {
    const hn::CappedTag<double, batch_lanes> across;
    const hn::CappedTag<double, 4> along;
    HWY_ALIGN double turned[4 * batch_lanes];
    for (std::size_t a = 0; a < nodes_per_tet; ++a, forces += 3 * batch_lanes, place += batch_lanes) {
        for (std::size_t l = 0; l < batch_lanes; l += hn::MaxLanes(across)) {
            const double* f = forces + l;
            hn::StoreInterleaved4(hn::Load(across, f), hn::Load(across, f + batch_lanes),
                                  hn::Load(across, f + 2 * batch_lanes), hn::Zero(across), across, turned + 4 * l);
        }
        for (std::size_t l = 0; l < batch_lanes; ++l) {
            for (std::size_t i = 0; i < 4; i += hn::MaxLanes(along)) {
                double* sum = list + 4 * place[l] + i;
                hn::Store(hn::Add(hn::Load(along, sum), hn::Load(along, turned + 4 * l + i)), along, sum);
            }
        }
    }
}

}  // namespace pliant::sim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pliant::sim {

HWY_EXPORT(add_to_list);

NodeSums::NodeSums(std::span<const int> nodes, std::size_t nodes_per_tet, std::size_t node_count)
    : width_(nodes_per_tet * batch_lanes), batches_(nodes.size() / width_) {
    static_assert(batches_per_piece * 10 * batch_lanes <= std::numeric_limits<std::uint16_t>::max());
    place_.resize(nodes.size());
    std::vector<int> listed;                     // nodes of all lists, one list after the other
    std::vector<std::size_t> place(node_count);  // position of a node in `listed`, if it is in the current list
    for (std::size_t begin = 0; begin < batches_; begin += batches_per_piece) {
        const std::size_t end = std::min(batches_, begin + batches_per_piece), start = listed.size();
        for (std::size_t k = begin * width_; k < end * width_; ++k) {
            std::size_t& at = place[static_cast<std::size_t>(nodes[k])];
            if (at < start || at >= listed.size() || listed[at] != nodes[k]) {
                at = listed.size();
                listed.push_back(nodes[k]);
            }
            place_[k] = static_cast<std::uint16_t>(at - start);
        }
        list_start_.push_back(listed.size());
    }
    uses_ = linalg::members_of(listed, static_cast<int>(node_count));
}

void NodeSums::clear(std::size_t piece, double* lists) const {
    std::fill(lists + stride * list_start_[piece], lists + stride * list_start_[piece + 1], 0.0);
}

void NodeSums::add(std::size_t batch, const double* forces, double* lists) const {
    HWY_DYNAMIC_DISPATCH(add_to_list)
    (forces, place_.data() + batch * width_, width_ / batch_lanes,
     lists + stride * list_start_[batch / batches_per_piece]);
}

void NodeSums::gather(const double* lists, std::span<double> result) const {
    parallel_for(uses_.start.size() - 1, 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t node = begin; node < end; ++node) {
            for (int k = uses_.start[node]; k < uses_.start[node + 1]; ++k) {
                const double* sum = lists + stride * static_cast<std::size_t>(uses_.item[k]);
                for (std::size_t i = 0; i < 3; ++i) result[3 * node + i] += sum[i];
            }
        }
    });
}

}  // namespace pliant::sim
#endif
