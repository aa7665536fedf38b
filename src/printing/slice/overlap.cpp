#include "printing/slice/overlap.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "printing/slice/outline_clusters.hpp"

namespace pliant::slice {
namespace {

std::vector<double> heights_of(std::span<const Edge> edges) {
    std::vector<double> heights;
    for (const Edge& e : edges) {
        heights.push_back(e.y0);
        heights.push_back(e.y1);
    }
    std::sort(heights.begin(), heights.end());
    heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
    return heights;
}

int owner(std::span<const Windings::value_type> inside) {
    return inside.empty() ? -1 : inside.back().first;
}

/// An edge with the bodies on both sides, from a height on; -1: none.
struct Border {
    double from, to;
    int left, right;
};

class Sweep {
public:
    explicit Sweep(std::span<const int> material_of)
        : material_of_(material_of),
          layer_{std::vector<Overlap>(material_of.size()), std::vector<std::vector<Segment>>(material_of.size())} {}

    void over(const Cluster& cluster) {
        edges_ = cluster.edges;
        around_ = cluster.around;
        borders_.assign(edges_.size(), {0, 0, -1, -1});
        active_.clear();
        const std::vector<double> heights = heights_of(edges_);
        std::size_t next = 0;
        for (std::size_t i = 0; i + 1 < heights.size(); ++i) {
            std::erase_if(active_, [&](std::size_t e) { return edges_[e].y1 <= heights[i]; });
            for (; next < edges_.size() && edges_[next].y0 <= heights[i]; ++next) active_.push_back(next);
            band(heights[i], heights[i + 1]);
        }
        for (std::size_t e = 0; e < edges_.size(); ++e) finish(e);
    }

    DividedLayer take() { return std::move(layer_); }

private:
    struct Passing {
        double low, high;  ///< x at the band's bottom and top
        std::size_t edge;
    };

    /// Splits the band where edges cross.
    void band(double bottom, double top) {
        passing_.clear();
        for (const std::size_t e : active_) passing_.push_back({edges_[e].at(bottom), edges_[e].at(top), e});
        std::sort(passing_.begin(), passing_.end(), [](const Passing& l, const Passing& r) {
            return std::pair(l.low, l.high) < std::pair(r.low, r.high);
        });
        cuts_.assign(1, bottom);
        // While sorting by the upper end, every exchange is a crossing.
        for (std::size_t i = 1; i < passing_.size(); ++i) {
            const Passing p = passing_[i];
            std::size_t j = i;
            for (; j > 0 && p.high < passing_[j - 1].high; --j) {
                const double before = p.low - passing_[j - 1].low, after = passing_[j - 1].high - p.high;
                cuts_.push_back(bottom + (top - bottom) * before / (before + after));
                passing_[j] = passing_[j - 1];
            }
            passing_[j] = p;
        }
        std::sort(cuts_.begin(), cuts_.end());
        cuts_.push_back(top);
        for (std::size_t i = 0; i + 1 < cuts_.size(); ++i) {
            if (cuts_[i + 1] > cuts_[i]) add(cuts_[i], cuts_[i + 1]);
        }
    }

    /// A band without crossings: trapezoids between neighbouring edges, with areas from their widths at mid-height.
    void add(double bottom, double top) {
        const double middle = (bottom + top) / 2, height = top - bottom;
        crossed_.clear();
        for (const std::size_t e : active_) crossed_.emplace_back(edges_[e].at(middle), e);
        std::sort(crossed_.begin(), crossed_.end());
        inside_.assign(around_.begin(), around_.end());
        int left = owner(around_);
        for (std::size_t i = 0; i < crossed_.size(); ++i) {
            const std::size_t e = crossed_[i].second;
            pass(inside_, edges_[e]);
            const int right = owner(inside_);
            if (left != right) border(e, {bottom, top, left, right});
            left = right;
            if (i + 1 == crossed_.size()) continue;
            const double area = (crossed_[i + 1].first - crossed_[i].first) * height;
            claim(inside_, area);
            claim(around_, -area);  // which the cluster around has claimed
        }
    }

    void claim(std::span<const Windings::value_type> inside, double area) {
        if (inside.empty()) return;
        const int last = inside.back().first, material = material_of_[static_cast<std::size_t>(last)];
        for (const auto& [body, winding] : inside) {
            Overlap& areas = layer_.areas[static_cast<std::size_t>(body)];
            areas.own += (std::abs(winding) - 1) * area;
            if (body == last) continue;
            (material_of_[static_cast<std::size_t>(body)] == material ? areas.own : areas.others) += area;
        }
    }

    /// Pieces of an edge between the same bodies are merged, so that a straight line stays one segment.
    void border(std::size_t edge, const Border& piece) {
        Border& known = borders_[edge];
        if (known.to == piece.from && known.left == piece.left && known.right == piece.right) {
            known.to = piece.to;
            return;
        }
        finish(edge);
        known = piece;
    }

    void finish(std::size_t edge) {
        const auto& [from, to, left, right] = borders_[edge];
        if (left == right) return;
        const double x0 = edges_[edge].at(from), x1 = edges_[edge].at(to);
        if (left >= 0) layer_.kept[static_cast<std::size_t>(left)].push_back({x1, to, x0, from});
        if (right >= 0) layer_.kept[static_cast<std::size_t>(right)].push_back({x0, from, x1, to});
    }

    std::span<const int> material_of_;
    DividedLayer layer_;
    std::span<const Edge> edges_;  ///< of the cluster at hand
    std::span<const Windings::value_type> around_;
    std::vector<Border> borders_;  ///< per edge, the part that is not in `layer_` yet
    std::vector<std::size_t> active_;
    std::vector<Passing> passing_;
    std::vector<double> cuts_;
    std::vector<std::pair<double, std::size_t>> crossed_;
    Windings inside_;
};

}  // namespace

DividedLayer divided(std::span<const std::vector<Segment>> outlines, std::span<const int> material_of) {
    Sweep sweep(material_of);
    for (const Cluster& cluster : clusters_of(outlines)) sweep.over(cluster);
    return sweep.take();
}

}  // namespace pliant::slice
