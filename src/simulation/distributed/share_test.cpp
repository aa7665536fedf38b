#include "simulation/distributed/share.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numeric>
#include <set>

#include "base/core/near.hpp"
#include "simulation/actuators/cable_path.hpp"
#include "simulation/actuators/chamber_surface.hpp"
#include "simulation/distributed/pack.hpp"
#include "simulation/elements/elements.hpp"
#include "simulation/model/check.hpp"

namespace pliant::sim::distributed {
namespace {

constexpr int ranks = 3;

/// A bar of 6 x 2 x 2 cubes of six tets each, held at one end, with a load, a cable along it, and a pressed wall around
/// it as a chamber.
Description bar() {
    Description d;
    constexpr int nx = 6, ny = 2, nz = 2;
    const auto id = [](int i, int j, int k) { return (k * (ny + 1) + j) * (nx + 1) + i; };
    for (int k = 0; k <= nz; ++k)
        for (int j = 0; j <= ny; ++j)
            for (int i = 0; i <= nx; ++i) d.mesh.points.push_back({0.01 * i, 0.01 * j, 0.01 * k});
    constexpr std::array<std::array<int, 3>, 6> orders{
        {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
    for (int k = 0; k < nz; ++k)
        for (int j = 0; j < ny; ++j)
            for (int i = 0; i < nx; ++i)
                for (std::size_t o = 0; o < orders.size(); ++o) {
                    std::array<int, 3> at{i, j, k};
                    std::array<int, 4> tet{id(i, j, k)};
                    for (std::size_t s = 0; s < 3; ++s) {
                        ++at[static_cast<std::size_t>(orders[o][s])];
                        tet[s + 1] = id(at[0], at[1], at[2]);
                    }
                    const auto& p = d.mesh.points;
                    if (mesh::signed_tet_volume(p[tet[0]], p[tet[1]], p[tet[2]], p[tet[3]]) < 0)
                        std::swap(tet[2], tet[3]);
                    d.mesh.nodes.insert(d.mesh.nodes.end(), tet.begin(), tet.end());
                    d.mesh.region.push_back(i < 3 ? 0 : 1);
                }
    d.mesh.region_names = {"root", "tip"};
    d.materials = {{"soft", material::neo_hookean(1e6, 0.45), 1100}, {"firm", material::neo_hookean(4e6, 0.4), 1200}};
    d.material_of_region = {0, 1};
    Support clamp;
    clamp.name = "clamp";
    for (int k = 0; k <= nz; ++k)
        for (int j = 0; j <= ny; ++j) clamp.nodes.push_back(id(0, j, k));
    d.supports.push_back(clamp);
    d.loads.push_back({"push", {id(nx, 0, 0), id(nx, 2, 2), id(3, 1, 1)}, {0.25, 0.25, 0.5}, {0, 0, 1}});
    Cable cable;
    cable.name = "flexor";
    for (const int i : {0, 2, 4, 6}) cable.points.push_back({{id(i, 1, 2), id(i, 0, 2)}, {0.7, 0.3}, {}});
    d.cables.push_back(cable);
    Wall wall;
    std::map<int, int> point;
    for (const mesh::Face& face : mesh::boundary_faces(d.mesh)) {
        WallFace own{-1, -1, -1, -1, -1, -1};
        for (std::size_t c = 0; c < 3; ++c) {
            const auto [there, added] = point.emplace(face.nodes[c], static_cast<int>(wall.points.size()));
            if (added) wall.points.push_back({{face.nodes[c]}, {1.0}, {}});
            own[c] = there->second;
        }
        wall.faces.push_back(own);
    }
    d.chambers.push_back({"air", wall, {}});
    d.markers.push_back({"tip", {{id(nx, 1, 1)}, {1.0}, {}}});
    return d;
}

/// Slices along the bar, with some nodes out of line.
std::vector<int> owners(const Description& d) {
    std::vector<int> owner;
    for (std::size_t n = 0; n < d.mesh.points.size(); ++n)
        owner.push_back(n % 11 == 0 ? static_cast<int>(n) % ranks
                                    : std::min(ranks - 1, static_cast<int>(d.mesh.points[n].x / 0.021)));
    return owner;
}

std::vector<Share> shares_of(const Description& d, const std::vector<int>& owner) {
    const HeldNodes held = *check(d);
    ShareBuilder builder(d, held, owner, ranks);
    CHECK(builder.idle_ranks() == 0);
    std::vector<Share> shares;
    for (int rank = 0; rank < ranks; ++rank) shares.push_back(unpacked(packed(builder.share_of(rank))));
    return shares;
}

std::vector<double> numbers_of(const std::vector<Vec3>& points) {
    std::vector<double> numbers;
    for (const Vec3& p : points) numbers.insert(numbers.end(), {p.x, p.y, p.z});
    return numbers;
}

/// A bent and stretched state.
std::vector<double> deformed(const std::vector<Vec3>& points) {
    std::vector<Vec3> moved;
    for (const Vec3& p : points) moved.push_back({1.1 * p.x, p.y + 2 * p.x * p.x, p.z - 3 * p.x * p.x + 0.1 * p.y});
    return numbers_of(moved);
}

}  // namespace

TEST_CASE("every tet and every node belongs to one rank") {
    const Description d = bar();
    const std::vector<int> owner = owners(d);
    std::multiset<int> tets, nodes, numbers;
    for (const Share& share : shares_of(d, owner)) {
        tets.insert(share.tet_in_file.begin(), share.tet_in_file.end());
        nodes.insert(share.node_in_file.begin(), share.node_in_file.begin() + share.owned);
        numbers.insert(share.number.begin(), share.number.begin() + share.owned);
        CHECK(share.part.mesh.points.size() == share.number.size());
        for (std::size_t k = 0; k < share.part.mesh.tet_count(); ++k)
            for (std::size_t c = 0; c < 4; ++c)
                CHECK(share.node_in_file[static_cast<std::size_t>(share.part.mesh.tet(k)[c])] ==
                      d.mesh.tet(static_cast<std::size_t>(share.tet_in_file[k]))[c]);
    }
    std::vector<int> all(d.mesh.tet_count());
    std::iota(all.begin(), all.end(), 0);
    CHECK(std::ranges::equal(tets, all));
    all.resize(d.mesh.points.size());
    std::iota(all.begin(), all.end(), 0);
    CHECK(std::ranges::equal(nodes, all));
    CHECK(std::ranges::equal(numbers, all));
}

TEST_CASE("energies, forces, lengths, volumes and loads of the shares add up to those of the whole") {
    const Description d = bar();
    const std::vector<double> x = deformed(d.mesh.points), rest = numbers_of(d.mesh.points);
    const Elements whole = *Elements::create(d);
    std::vector<double> forces(x.size(), 0.0);
    const double energy = whole.evaluate(x, forces).energy_J;
    const double length = CablePath(d.cables[0].points, rest).length(x);
    const double volume = ChamberSurface(d.chambers[0].wall, rest).volume(x);
    double energy_sum = 0, length_sum = 0, volume_sum = 0, load_sum = 0, mass_sum = 0;
    std::vector<double> force_sums(x.size(), 0.0);
    for (const Share& share : shares_of(d, owners(d))) {
        const std::vector<double> own_x = deformed(share.part.mesh.points),
                                  own_rest = numbers_of(share.part.mesh.points);
        const Elements elements = *Elements::create(share.part);
        std::vector<double> own(own_x.size(), 0.0);
        energy_sum += elements.evaluate(own_x, own).energy_J;
        for (std::size_t n = 0; n < share.node_in_file.size(); ++n)
            for (std::size_t c = 0; c < 3; ++c)
                force_sums[3 * static_cast<std::size_t>(share.node_in_file[n]) + c] += own[3 * n + c];
        for (const double mass : elements.node_mass_kg()) mass_sum += mass;
        for (const Cable& cable : share.part.cables)
            if (!cable.points.empty()) length_sum += CablePath(cable.points, own_rest).length(own_x);
        for (const Chamber& chamber : share.part.chambers)
            if (!chamber.wall.faces.empty()) volume_sum += ChamberSurface(chamber.wall, own_rest).volume(own_x);
        for (const double load : share.part.loads[0].shares) load_sum += load;
    }
    double largest = 0;
    for (const double f : forces) largest = std::max(largest, std::fabs(f));
    CHECK(energy_sum == near(energy, {.relative = 1e-12}));
    CHECK(length_sum == near(length, {.relative = 1e-12}));
    CHECK(volume_sum == near(volume, {.relative = 1e-12}));
    CHECK(load_sum == near(1, {.relative = 1e-12}));
    CHECK(mass_sum ==
          near(std::accumulate(whole.node_mass_kg().begin(), whole.node_mass_kg().end(), 0.0), {.relative = 1e-12}));
    for (std::size_t k = 0; k < forces.size(); ++k)
        CHECK(force_sums[k] == near(forces[k], {.absolute = 1e-12 * largest}));
}

TEST_CASE("what is held is held on every rank that knows it") {
    const Description d = bar();
    for (const Share& share : shares_of(d, owners(d))) {
        for (std::size_t n = 0; n < share.fixed.size(); ++n)
            CHECK((share.fixed[n] != 0) == (share.part.mesh.points[n].x == 0));
        CHECK(share.part.supports.size() == 1);
        CHECK(share.part.supports[0].nodes.size() ==
              static_cast<std::size_t>(std::ranges::count(share.fixed, char{1})));
    }
}

}  // namespace pliant::sim::distributed
