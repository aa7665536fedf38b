#include "geometry/repair/narrow_gaps.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <unordered_map>
#include <utility>

#include "base/core/boxes.hpp"
#include "geometry/mesh/tet_locator.hpp"

namespace pliant::mesh {
namespace {

/// A single region.
struct Piece {
    TetMesh mesh;
    Box3 box;
    std::vector<int> own;       ///< (nodes of the whole mesh) index in `mesh`, or -1
    std::vector<Face> surface;  ///< nodes of the whole mesh
};

Piece piece_of(const TetMesh& mesh, int region) {
    std::vector<bool> keep(mesh.region_names.size(), false);
    keep[static_cast<std::size_t>(region)] = true;
    Extract extract = extract_regions(mesh, keep);
    Piece piece{std::move(extract.mesh), {}, std::move(extract.node), region_faces(mesh, region)};
    piece.box = bounds_of(piece.mesh.points);
    return piece;
}

/// Largest distance of the surface of `one` from `other`, and its place; 0 if no face is near without being shared.
/// Only whole faces count: single nodes may be near by chance, where round bodies are approximated by chords.
std::pair<double, Vec3> widest(const TetMesh& mesh, const Piece& one, const Piece& other, const TetLocator& locator,
                               double tolerance) {
    constexpr double touching = 1e-6;  // as a fraction of the tolerance
    std::unordered_map<int, double> known;
    const auto distance = [&](int node) {
        if (other.own[static_cast<std::size_t>(node)] >= 0) return 0.0;
        const Vec3& p = mesh.points[static_cast<std::size_t>(node)];
        if (!other.box.contains(p, tolerance)) return std::numeric_limits<double>::infinity();
        const auto [entry, fresh] = known.try_emplace(node, 0.0);
        if (fresh) entry->second = locator.locate(p).distance;
        return entry->second;
    };
    std::pair<double, Vec3> most{0, {}};
    for (const Face& face : one.surface) {
        const std::array<double, 3> d = {distance(face.nodes[0]), distance(face.nodes[1]), distance(face.nodes[2])};
        const auto largest = std::max_element(d.begin(), d.end());
        if (*largest <= touching * tolerance || *largest > tolerance || *largest <= most.first) continue;
        const int node = face.nodes[static_cast<std::size_t>(largest - d.begin())];
        most = {*largest, mesh.points[static_cast<std::size_t>(node)]};
    }
    return most;
}

}  // namespace

std::vector<NarrowGap> narrow_gaps(const TetMesh& mesh, double tolerance) {
    std::vector<Piece> pieces;
    const int regions = static_cast<int>(mesh.region_names.size());
    for (int r = 0; r < regions && regions > 1; ++r) pieces.push_back(piece_of(mesh, r));
    std::vector<std::optional<TetLocator>> locators(pieces.size());
    const auto locator = [&](std::size_t r) -> const TetLocator& {
        if (!locators[r]) locators[r].emplace(pieces[r].mesh);
        return *locators[r];
    };
    std::vector<NarrowGap> gaps;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        for (std::size_t j = i + 1; j < pieces.size(); ++j) {
            const bool empty = pieces[i].mesh.tet_count() == 0 || pieces[j].mesh.tet_count() == 0;
            if (empty || !boxes_meet(pieces[i].box, pieces[j].box, tolerance)) continue;
            const auto there = widest(mesh, pieces[i], pieces[j], locator(j), tolerance);
            const auto back = widest(mesh, pieces[j], pieces[i], locator(i), tolerance);
            const auto& [width, at] = there.first >= back.first ? there : back;
            if (width > 0) gaps.push_back({static_cast<int>(i), static_cast<int>(j), width, at});
        }
    }
    return gaps;
}

}  // namespace pliant::mesh
