#include "geometry/meshing/editable_tets.hpp"

#include <cmath>

namespace pliant::mesh {
namespace {

/// The corners of the edge shared by faces i and j (opposite to corners i and j).
std::pair<std::size_t, std::size_t> common_edge(std::size_t i, std::size_t j) {
    std::size_t k = 0;
    while (k == i || k == j) ++k;
    return {k, 6 - i - j - k};
}

}  // namespace

// sin = 3 V l / (2 A B), with l the edge between faces of areas A and B.
double smallest_sine(const std::array<Vec3, 4>& p) {
    const double volume6 = 6 * signed_tet_volume(p[0], p[1], p[2], p[3]);
    std::array<double, 4> area2{};
    for (std::size_t f = 0; f < 4; ++f) {
        const auto at = [&](std::size_t k) { return p[static_cast<std::size_t>(face_corners[f][k])]; };
        area2[f] = norm(cross(at(1) - at(0), at(2) - at(0)));
        if (!(area2[f] > 0)) return 0;
    }
    double least = 1;
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            const auto [a, b] = common_edge(i, j);
            least = std::min(least, volume6 * norm(p[a] - p[b]) / (area2[i] * area2[j]));
        }
    }
    return least;
}

EditableTets::EditableTets(const TetMesh& mesh)
    : points_(mesh.points), region_(mesh.region), star_(mesh.points.size()) {
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        const auto n = mesh.tet(t);
        tets_.push_back({n[0], n[1], n[2], n[3]});
        for (const int v : tets_.back()) star_[index(v)].push_back(static_cast<int>(t));
    }
}

Triangle EditableTets::face(int t, std::size_t f) const {
    Triangle nodes{};
    for (std::size_t k = 0; k < 3; ++k) nodes[k] = tet(t)[index(face_corners[f][k])];
    return nodes;
}

Vec3 EditableTets::normal(const Triangle& n) const {
    const Vec3 area = cross(at(n[1]) - at(n[0]), at(n[2]) - at(n[0]));
    const double length = norm(area);
    return length > 0 ? area / length : Vec3{};
}

std::vector<int> EditableTets::around(int a, int b) const {
    std::vector<int> found;
    for (const int t : star_[index(a)]) {
        if (holds(t, b)) found.push_back(t);
    }
    return found;
}

int EditableTets::behind(int t, std::size_t f) const {
    const auto node = [&](std::size_t k) { return tet(t)[index(face_corners[f][k])]; };
    for (const int other : star_[index(node(0))]) {
        if (other != t && holds(other, node(1)) && holds(other, node(2))) return other;
    }
    return -1;
}

std::optional<Border> EditableTets::border(int t, std::size_t f) const {
    const int other = behind(t, f);
    if (other >= 0 && region_[index(other)] <= region_[index(t)]) return std::nullopt;
    const Triangle nodes = face(t, f);
    return Border{nodes, normal(nodes)};
}

std::vector<Border> EditableTets::borders(int v) const {
    std::vector<Border> found;
    for (const int t : star_[index(v)]) {
        for (std::size_t f = 0; f < 4; ++f) {
            if (tet(t)[f] == v) continue;
            if (const auto one = border(t, f)) found.push_back(*one);
        }
    }
    return found;
}

bool EditableTets::apply(const Exchange& change, double tolerance, const std::vector<int>& regions) {
    double volume = 0, size = 0;
    for (const int t : change.removed) {
        volume += tet_volume(tet(t));
        size = std::max(size, norm(at(tet(t)[0]) - at(tet(t)[1])));
    }
    for (const Tet& n : change.added) volume -= tet_volume(n);
    if (std::fabs(volume) > tolerance * size * size * size) return false;
    const int region = region_[index(change.removed.front())];
    Step step{{}, change.added.size(), -1, {}};
    for (const int t : change.removed) {
        for (const int v : tet(t)) std::erase(star_[index(v)], t);
        step.removed.emplace_back(t, std::exchange(region_[index(t)], -1));
    }
    for (std::size_t i = 0; i < change.added.size(); ++i) {
        const int t = static_cast<int>(tets_.size());
        tets_.push_back(change.added[i]);
        region_.push_back(regions.empty() ? region : regions[i]);
        for (const int v : tets_.back()) star_[index(v)].push_back(t);
    }
    log_.push_back(std::move(step));
    return true;
}

int EditableTets::add_node(const Vec3& p) {
    points_.push_back(p);
    star_.emplace_back();
    return static_cast<int>(points_.size()) - 1;
}

std::vector<int> EditableTets::touched_since(std::size_t mark, int first_new) const {
    std::vector<int> touched;
    for (int t = first_new; t < static_cast<int>(tets_.size()); ++t) {
        if (alive(t)) touched.push_back(t);
    }
    for (std::size_t i = mark; i < log_.size(); ++i) {
        if (log_[i].moved < 0) continue;
        const std::vector<int>& star = star_[index(log_[i].moved)];
        touched.insert(touched.end(), star.begin(), star.end());
    }
    return touched;
}

void EditableTets::undo(std::size_t mark) {
    for (; log_.size() > mark; log_.pop_back()) {
        const Step& step = log_.back();
        if (step.moved >= 0) {
            points_[index(step.moved)] = step.from;
            continue;
        }
        for (std::size_t i = 0; i < step.added; ++i) {
            const int t = static_cast<int>(tets_.size()) - 1;
            for (const int v : tets_.back()) std::erase(star_[index(v)], t);
            tets_.pop_back();
            region_.pop_back();
        }
        for (const auto& [t, region] : step.removed) {
            region_[index(t)] = region;
            for (const int v : tet(t)) star_[index(v)].push_back(t);
        }
    }
}

void EditableTets::store(TetMesh& mesh) const {
    std::vector<int> number(points_.size(), -1);
    std::vector<Vec3> points;
    for (std::size_t v = 0; v < points_.size(); ++v) {
        if (star_[v].empty()) continue;
        number[v] = static_cast<int>(points.size());
        points.push_back(points_[v]);
    }
    mesh.nodes.clear();
    mesh.region.clear();
    for (int t = 0; t < static_cast<int>(tets_.size()); ++t) {
        if (!alive(t)) continue;
        for (const int v : tet(t)) mesh.nodes.push_back(number[index(v)]);
        mesh.region.push_back(region_[index(t)]);
    }
    mesh.points = std::move(points);
}

}  // namespace pliant::mesh
