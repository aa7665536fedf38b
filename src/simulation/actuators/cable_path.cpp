#include "simulation/actuators/cable_path.hpp"

#include <algorithm>
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
        if (to.nodes.empty()) segment.offset += to.fixed;
        if (from.nodes.empty()) segment.offset -= from.fixed;
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

void CablePath::add_hessian(std::span<const double> x, double factor, const std::vector<int>& free_index,
                            const linalg::SymmetricPattern& pattern, std::span<double> values,
                            std::span<const double> shares) const {
    for (std::size_t k = 0; k < segments_.size(); ++k) {
        const Segment& segment = segments_[k];
        const double pull = shares.empty() ? factor : factor * shares[k];
        const Vec3 d = vector_of(segment, x);
        const double l = std::max(norm(d), met_length_m_);
        const Vec3 t = norm(d) >= met_length_m_ ? d / l : Vec3{};
        for (std::size_t b = 0; b < segment.nodes.size(); ++b) {
            const int j = free_index[segment.nodes[b]];
            if (j < 0) continue;
            for (std::size_t a = 0; a < segment.nodes.size(); ++a) {
                const int i = free_index[segment.nodes[a]];
                if (i < j) continue;
                const double scale = pull * segment.weights[a] * segment.weights[b] / l;
                pattern.add_block(values, i, j, [&](int r, int c) {
                    const auto row = static_cast<std::size_t>(r);
                    const auto column = static_cast<std::size_t>(c);
                    return scale * ((r == c ? 1.0 : 0.0) - t[row] * t[column]);
                });
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
