#include "simulation/distributed/share.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "geometry/mesh/order_in_space.hpp"
#include "simulation/actuators/chamber_surface.hpp"

namespace pliant::sim::distributed {
namespace {

/// The rank that owns most corners. Ties go to the first one, starting at another corner in each tet, so that no rank
/// is preferred.
int majority(const std::array<int, 4>& ranks, std::size_t tet) {
    int best = -1;
    std::ptrdiff_t most = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        const int rank = ranks[(tet + k) % 4];
        const auto votes = std::ranges::count(ranks, rank);
        if (votes > most) {
            most = votes;
            best = rank;
        }
    }
    return best;
}

/// A copy of a support or load without its nodes.
template <class T>
T without(const T& whole, std::vector<int> T::*nodes) {
    T copy = whole;
    (copy.*nodes).clear();
    return copy;
}

Vec3 centre_of(const Wall& wall, const std::vector<Vec3>& rest) {
    Vec3 sum;
    const std::span<const double> x(&rest.data()->x, 3 * rest.size());
    for (const Attachment& point : wall.points) sum += position(point, x) / static_cast<double>(wall.points.size());
    return sum;
}

}  // namespace

ShareBuilder::ShareBuilder(const Description& description, const HeldNodes& held, const std::vector<int>& owner,
                           int ranks)
    : d_(description), owner_(owner), ranks_(ranks) {
    const mesh::TetMesh& mesh = d_.mesh;
    whole_.nodes = static_cast<int>(mesh.points.size());
    whole_.tets = static_cast<int>(mesh.tet_count());
    whole_.volume_m3 = mesh::volume(mesh);
    for (const Vec3& p : mesh.points)
        whole_.farthest_m = std::max({whole_.farthest_m, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
    for (const Material& material : d_.materials)
        whole_.stiffest_Pa = std::max(whole_.stiffest_Pa, material::stiffness_bound(material.law));
    local_.assign(mesh.points.size(), -1);
    give_tets();
    number_nodes();
    find_fixed(held);
    find_contact_nodes();
}

void ShareBuilder::give_tets() {
    tets_.resize(static_cast<std::size_t>(ranks_));
    for (std::size_t t = 0; t < d_.mesh.tet_count(); ++t) {
        const auto tet = d_.mesh.tet(t);
        std::array<int, 4> ranks{};
        for (std::size_t k = 0; k < 4; ++k) ranks[k] = owner_[static_cast<std::size_t>(tet[k])];
        tets_[static_cast<std::size_t>(majority(ranks, t))].push_back(static_cast<int>(t));
    }
}

void ShareBuilder::number_nodes() {
    nodes_.resize(static_cast<std::size_t>(ranks_));
    for (std::size_t n = 0; n < owner_.size(); ++n)
        nodes_[static_cast<std::size_t>(owner_[n])].push_back(static_cast<int>(n));
    const double layer = mesh::layer_of(d_.mesh);
    number_.resize(owner_.size());
    int next = 0;
    for (std::vector<int>& nodes : nodes_) {
        mesh::order_in_space(nodes, d_.mesh.points, layer);
        for (const int node : nodes) number_[static_cast<std::size_t>(node)] = next++;
    }
}

void ShareBuilder::find_fixed(const HeldNodes& held) {
    fixed_.assign(owner_.size(), 1);
    for (const int node : d_.mesh.nodes) fixed_[static_cast<std::size_t>(node)] = held.is_fixed(node) ? 1 : 0;
    for (const PressureLoad& load : d_.pressures) {
        const auto moves = [&](int node) { return fixed_[static_cast<std::size_t>(node)] == 0; };
        bool skews = false;
        for (const int point : rim_points(load.wall))
            skews = skews || std::ranges::any_of(load.wall.points[static_cast<std::size_t>(point)].nodes, moves);
        whole_.pressure_skews.push_back(skews ? 1 : 0);
    }
}

void ShareBuilder::find_contact_nodes() {
    contact_nodes_.assign(owner_.size(), 0);
    if (!d_.contact) return;
    for (const int node : d_.contact->surface.points) contact_nodes_[static_cast<std::size_t>(node)] = 1;
}

int ShareBuilder::idle_ranks() const {
    return static_cast<int>(std::ranges::count_if(tets_, [](const auto& tets) { return tets.empty(); }));
}

/// The index of a node in the share; new ones are added.
int ShareBuilder::local(int node, Share& share) {
    int& index = local_[static_cast<std::size_t>(node)];
    if (index < 0) {
        index = static_cast<int>(share.node_in_file.size());
        share.node_in_file.push_back(node);
    }
    return index;
}

void ShareBuilder::add_mesh(int rank, Share& share) {
    for (const int node : nodes_[static_cast<std::size_t>(rank)]) static_cast<void>(local(node, share));
    share.owned = static_cast<int>(share.node_in_file.size());
    mesh::TetMesh& mesh = share.part.mesh;
    mesh.order = d_.mesh.order;
    mesh.region_names = d_.mesh.region_names;
    share.tet_in_file = tets_[static_cast<std::size_t>(rank)];
    for (const int tet : share.tet_in_file) {
        const auto t = static_cast<std::size_t>(tet);
        for (const int node : d_.mesh.tet(t)) mesh.nodes.push_back(local(node, share));
        mesh.region.push_back(d_.mesh.region[t]);
        if (!d_.material_of_tet.empty()) share.part.material_of_tet.push_back(d_.material_of_tet[t]);
    }
}

int ShareBuilder::rank_of(const Attachment& point) const {
    return point.nodes.empty() ? -1 : owner_[static_cast<std::size_t>(point.nodes.front())];
}

/// That of the first point that is not fixed in space; rank 0 if all are.
int ShareBuilder::rank_of(const std::vector<Attachment>& points) const {
    const auto rides = std::ranges::find_if(points, [](const Attachment& point) { return !point.nodes.empty(); });
    return rides == points.end() ? 0 : rank_of(*rides);
}

void ShareBuilder::localise(Attachment& point, Share& share) {
    for (int& node : point.nodes) node = local(node, share);
}

Wall ShareBuilder::part_of(const Wall& wall, int rank, Share& share) {
    Wall part;
    std::vector<int> index(wall.points.size(), -1);
    const std::size_t first_mouth = wall.faces.size() - wall.mouth_faces;
    for (std::size_t f = 0; f < wall.faces.size(); ++f) {
        const WallFace& face = wall.faces[f];
        int face_rank = 0;  // if all points are fixed in space
        for (std::size_t i = 3; i-- > 0;)
            if (const int r = rank_of(wall.points[static_cast<std::size_t>(face[i])]); r >= 0) face_rank = r;
        if (face_rank != rank) continue;
        WallFace own = face;
        for (int& point : own) {
            if (point < 0) continue;
            int& there = index[static_cast<std::size_t>(point)];
            if (there < 0) {
                there = static_cast<int>(part.points.size());
                part.points.push_back(wall.points[static_cast<std::size_t>(point)]);
                localise(part.points.back(), share);
            }
            point = there;
        }
        part.faces.push_back(own);
        if (f >= first_mouth) ++part.mouth_faces;
    }
    return part;
}

/// Volumes of open parts add up to that of the whole only with respect to a common centre, and the centre of a wall is
/// the mean of its points. An additional point, which no face uses, moves it to that of the whole.
void move_centre(Wall& part, const Vec3& centre, const std::vector<Vec3>& rest) {
    if (part.faces.empty()) return;
    const auto count = static_cast<double>(part.points.size());
    const Vec3 own = centre_of(part, rest);
    part.points.push_back({{}, {}, (count + 1) * centre - count * own});
}

void ShareBuilder::add_actuators(int rank, Share& share) {
    for (const Cable& cable : d_.cables) {
        Cable own = cable;
        if (rank_of(cable.points) != rank) own.points.clear();
        for (Attachment& point : own.points) localise(point, share);
        share.part.cables.push_back(std::move(own));
    }
    for (const Chamber& chamber : d_.chambers)
        share.part.chambers.push_back({chamber.name, part_of(chamber.wall, rank, share), chamber.target});
    for (const PressureLoad& load : d_.pressures)
        share.part.pressures.push_back({load.name, part_of(load.wall, rank, share), load.pressure_Pa, load.share});
}

void ShareBuilder::add_loads(int rank, Share& share) {
    for (const Load& load : d_.loads) {
        Load own = without(load, &Load::nodes);
        own.shares.clear();
        for (std::size_t k = 0; k < load.nodes.size(); ++k) {
            if (owner_[static_cast<std::size_t>(load.nodes[k])] != rank) continue;
            own.nodes.push_back(local(load.nodes[k], share));
            own.shares.push_back(load.shares[k]);
        }
        share.part.loads.push_back(std::move(own));
    }
    for (const PointMass& mass : d_.masses) {
        if (rank_of(mass.point) != rank) continue;
        share.part.masses.push_back(mass);
        localise(share.part.masses.back().point, share);
    }
    for (const Marker& marker : d_.markers) {
        Marker own{marker.name, {}};
        if (std::max(rank_of(marker.point), 0) == rank) own.point = marker.point;
        localise(own.point, share);
        share.part.markers.push_back(std::move(own));
    }
}

/// For the nodes that the share has so far: all its local ones.
void ShareBuilder::add_supports(Share& share) {
    for (const Support& support : d_.supports) {
        Support own = without(support, &Support::nodes);
        for (const int node : support.nodes)
            if (const int index = local_[static_cast<std::size_t>(node)]; index >= 0) own.nodes.push_back(index);
        share.part.supports.push_back(std::move(own));
    }
}

Share ShareBuilder::share_of(int rank) {
    Share share;
    share.whole = whole_;
    Description& part = share.part;
    part.materials = d_.materials;
    part.material_of_region = d_.material_of_region;
    part.gravity_m_s2 = d_.gravity_m_s2;
    part.gravity_share = d_.gravity_share;
    part.ambient_pressure_Pa = d_.ambient_pressure_Pa;
    add_mesh(rank, share);
    add_actuators(rank, share);
    add_loads(rank, share);
    add_supports(share);
    for (const int node : share.node_in_file) {
        const auto n = static_cast<std::size_t>(node);
        part.mesh.points.push_back(d_.mesh.points[n]);
        share.number.push_back(number_[n]);
        share.fixed.push_back(fixed_[n]);
        if (contact_nodes_[n] != 0 && local_[n] < share.owned) share.contact_nodes.push_back(local_[n]);
        local_[n] = -1;
    }
    for (std::size_t c = 0; c < d_.chambers.size(); ++c)
        move_centre(part.chambers[c].wall, centre_of(d_.chambers[c].wall, d_.mesh.points), part.mesh.points);
    for (std::size_t k = 0; k < d_.pressures.size(); ++k)
        move_centre(part.pressures[k].wall, centre_of(d_.pressures[k].wall, d_.mesh.points), part.mesh.points);
    return share;
}

}  // namespace pliant::sim::distributed
