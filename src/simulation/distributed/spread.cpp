#include "simulation/distributed/spread.hpp"

#include <utility>

#include "simulation/distributed/pack.hpp"
#include "simulation/distributed/partition.hpp"
#include "simulation/model/check.hpp"

namespace pliant::sim::distributed {
namespace {

/// Root's own share; all others are on their way.
Result<Share> cut_and_send(const Ranks& ranks, const Description& description, const HeldNodes& held,
                           const std::vector<int>& owner) {
    Cutter cutter(description, held, owner, ranks.count());
    const Status enough = cutter.idle_ranks() == 0
                              ? Status{}
                              : input_error("{} tetrahedra are too few for {} ranks: {} would have none",
                                            description.mesh.tet_count(), ranks.count(), cutter.idle_ranks());
    if (Status status = ranks.agree(enough); !status) return tl::unexpected(status.error());
    for (int rank = 1; rank < ranks.count(); ++rank) ranks.send(packed(cutter.share_of(rank)), rank);
    return cutter.share_of(0);
}

}  // namespace

Result<Balance> spread(const Ranks& ranks, Description description) {
    Result<HeldNodes> held = ranks.is_root() ? check(description) : HeldNodes::create({}, 0);
    if (Status status = ranks.agree(held ? Status{} : tl::unexpected(held.error())); !status)
        return tl::unexpected(status.error());
    const std::vector<int> owner = node_owners(ranks, description.mesh);
    if (ranks.is_root()) {
        Result<Share> share = cut_and_send(ranks, description, *held, owner);
        if (!share) return tl::unexpected(share.error());
        description = {};
        return Balance::create(ranks, std::move(*share));
    }
    if (Status status = ranks.agree({}); !status) return tl::unexpected(status.error());
    return Balance::create(ranks, unpacked(ranks.receive()));
}

}  // namespace pliant::sim::distributed
