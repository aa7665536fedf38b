#include "simulation/distributed/distribute.hpp"

#include <utility>

#include "simulation/distributed/pack.hpp"
#include "simulation/distributed/partition.hpp"
#include "simulation/model/check.hpp"

namespace pliant::sim::distributed {
namespace {

/// On root, which knows the indices of tets in the whole mesh.
Status check_flat(const mesh::TetMesh& mesh) {
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        const auto point = [&](std::size_t k) { return mesh.points[static_cast<std::size_t>(mesh.tet(t)[k])]; };
        const double volume = mesh::signed_tet_volume(point(0), point(1), point(2), point(3));
        if (!(volume > 0))
            return input_error("tetrahedron {} of the mesh is flat or inside out at rest (volume {:.3g} m^3)", t,
                               volume);
    }
    return {};
}

/// Checks the robot and finds the held nodes.
Result<HeldNodes> checked(const Description& description) {
    Result<HeldNodes> held = check(description);
    if (!held) return held;
    if (Status status = check_flat(description.mesh); !status) return tl::unexpected(status.error());
    return held;
}

/// Sends the shares of the other ranks and returns root's own.
Result<Share> build_and_send(const Ranks& ranks, const Description& description, const HeldNodes& held,
                             const std::vector<int>& owner) {
    ShareBuilder builder(description, held, owner, ranks.count());
    const Status enough =
        builder.idle_ranks() == 0
            ? Status{}
            : input_error(
                  "{} tetrahedra are too few for {} ranks: {} would have none; start fewer ranks or use a finer mesh",
                  description.mesh.tet_count(), ranks.count(), builder.idle_ranks());
    if (Status status = ranks.agree(enough); !status) return tl::unexpected(status.error());
    for (int rank = 1; rank < ranks.count(); ++rank) ranks.send(packed(builder.share_of(rank)), rank);
    return builder.share_of(0);
}

}  // namespace

Result<DistributedEquilibrium> distribute(const Ranks& ranks, Description description) {
    Result<HeldNodes> held = ranks.is_root() ? checked(description) : HeldNodes::create({}, 0);
    if (Status status = ranks.agree(held ? Status{} : tl::unexpected(held.error())); !status)
        return tl::unexpected(status.error());
    const std::vector<int> owner = node_owners(ranks, description.mesh);
    if (ranks.is_root()) {
        Result<Share> share = build_and_send(ranks, description, *held, owner);
        if (!share) return tl::unexpected(share.error());
        description = {};
        return DistributedEquilibrium::create(ranks, std::move(*share));
    }
    if (Status status = ranks.agree({}); !status) return tl::unexpected(status.error());
    return DistributedEquilibrium::create(ranks, unpacked(ranks.receive()));
}

}  // namespace pliant::sim::distributed
