#include "simulation/actuators/cable_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace pliant::sim {

CablePath::CablePath(std::span<const Attachment> points, std::span<const double> rest) {
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
        const Attachment& from = points[k];
        const Attachment& to = points[k + 1];
        std::map<int, double> weight;
        for (std::size_t i = 0; i < to.nodes.size(); ++i) weight[to.nodes[i]] += to.weights[i];
        for (std::size_t i = 0; i < from.nodes.size(); ++i) weight[from.nodes[i]] -= from.weights[i];
        Segment segment;
        for (const auto& [node, w] : weight) {
            segment.nodes.push_back(node);
            segment.weights.push_back(w);
        }
        segment.offset = to.fixed - from.fixed;
        segments_.push_back(std::move(segment));
    }
    const double total = length(rest);
    met_length_m_ = 1e-3 * total;
    for (const Segment& segment : segments_)
        met_length_m_ = std::min(met_length_m_, 0.25 * norm(vector_of(segment, rest)));
    met_length_m_ = std::max(met_length_m_, 1e-9 * total);
}

Vec3 CablePath::vector_of(const Segment& segment, std::span<const double> x) {
    Vec3 d = segment.offset;
    for (std::size_t i = 0; i < segment.nodes.size(); ++i) {
        const double* p = x.data() + 3 * static_cast<std::size_t>(segment.nodes[i]);
        d += segment.weights[i] * Vec3{p[0], p[1], p[2]};
    }
    return d;
}

double CablePath::length(std::span<const double> x, std::span<const double> shares) const {
    double sum = 0;
    for (std::size_t k = 0; k < segments_.size(); ++k) {
        const double l = norm(vector_of(segments_[k], x));
        const double smooth = l >= met_length_m_ ? l : 0.5 * (l * l / met_length_m_ + met_length_m_);
        sum += shares.empty() ? smooth : shares[k] * smooth;
    }
    return sum;
}

std::vector<double> CablePath::tension_shares(std::span<const double> x, double friction, bool pulled_at_first) const {
    std::vector<double> shares(segments_.size(), 1.0);
    double share = 1;
    Vec3 before;  // direction of the last segment towards the pulled end; zero before the first
    for (std::size_t step = 0; step < segments_.size(); ++step) {
        const std::size_t k = pulled_at_first ? step : segments_.size() - 1 - step;
        const Vec3 d = vector_of(segments_[k], x);
        if (norm(d) >= met_length_m_) {  // points that have met do not bend the cable
            const Vec3 direction = unit(d);
            if (norm(before) > 0)
                share *= std::exp(-friction * std::acos(std::clamp(dot(before, direction), -1.0, 1.0)));
            before = direction;
        }
        shares[k] = share;
    }
    return shares;
}

int CablePath::closed_segment(std::span<const double> x) const {
    for (std::size_t k = 0; k < segments_.size(); ++k) {
        if (norm(vector_of(segments_[k], x)) < met_length_m_) return static_cast<int>(k);
    }
    return -1;
}

void CablePath::add_gradient(std::span<const double> x, double factor, std::span<double> forces,
                             std::span<const double> shares) const {
    for (std::size_t k = 0; k < segments_.size(); ++k) {
        const Segment& segment = segments_[k];
        const double pull = shares.empty() ? factor : factor * shares[k];
        const Vec3 d = vector_of(segment, x);
        const double l = std::max(norm(d), met_length_m_);
        for (std::size_t i = 0; i < segment.nodes.size(); ++i) {
            const Vec3 f = (pull * segment.weights[i] / l) * d;
            double* target = forces.data() + 3 * static_cast<std::size_t>(segment.nodes[i]);
            target[0] += f.x;
            target[1] += f.y;
            target[2] += f.z;
        }
    }
}

std::vector<CablePath::NodeGradient> CablePath::gradient(std::span<const double> x) const {
    std::map<int, Vec3> sums;
    for (const Segment& segment : segments_) {
        const Vec3 d = vector_of(segment, x);
        const double l = std::max(norm(d), met_length_m_);
        for (std::size_t i = 0; i < segment.nodes.size(); ++i) sums[segment.nodes[i]] += (segment.weights[i] / l) * d;
    }
    return {sums.begin(), sums.end()};
}

std::vector<int> CablePath::nodes() const {
    std::vector<int> all;
    for (const Segment& segment : segments_) all.insert(all.end(), segment.nodes.begin(), segment.nodes.end());
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

namespace {

struct WeightedNode {
    int free;
    double weight;
};

/// The free nodes of a segment, ascending.
std::vector<WeightedNode> free_nodes(std::span<const int> nodes, std::span<const double> weights,
                                     const std::vector<int>& free_index) {
    std::vector<WeightedNode> sorted;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        if (const int free = free_index[nodes[k]]; free >= 0) sorted.push_back({free, weights[k]});
    }
    std::ranges::sort(sorted, {}, &WeightedNode::free);
    return sorted;
}

}  // namespace

void CablePath::add_hessian(std::span<const double> x, double factor, const std::vector<int>& free_index,
                            const linalg::SymmetricPattern& pattern, std::span<double> values,
                            std::span<const double> shares) const {
    for (std::size_t k = 0; k < segments_.size(); ++k) {
        const Segment& segment = segments_[k];
        const double pull = shares.empty() ? factor : factor * shares[k];
        const Vec3 d = vector_of(segment, x);
        const double l = std::max(norm(d), met_length_m_);
        const Vec3 t = norm(d) >= met_length_m_ ? d / l : Vec3{};
        std::array<double, 9> across{};  // I - t t^T
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t r = 0; r < 3; ++r) across[3 * c + r] = (r == c ? 1.0 : 0.0) - t[r] * t[c];
        }
        const std::vector<WeightedNode> nodes = free_nodes(segment.nodes, segment.weights, free_index);
        for (std::size_t b = 0; b < nodes.size(); ++b) {
            // An eyelet couples so many nodes that a search for each pair would take longer than what is added there.
            int at = pattern.node_start[nodes[b].free];
            for (std::size_t a = b; a < nodes.size(); ++a) {
                while (pattern.node_row[at] != nodes[a].free) ++at;
                const double scale = pull * nodes[a].weight * nodes[b].weight / l;
                double* block = values.data() + 9 * static_cast<std::size_t>(at);
                for (std::size_t e = 0; e < 9; ++e) block[e] += scale * across[e];
            }
        }
    }
}

void CablePath::append_cliques(const std::vector<int>& free_index, linalg::Lists& cliques) const {
    for (const Segment& segment : segments_) {
        std::vector<int> clique;
        for (const int node : segment.nodes) clique.push_back(free_index[node]);
        cliques.push_back(clique);
    }
}

}  // namespace pliant::sim
