#include "slice/overlap.hpp"

#include <algorithm>
#include <utility>

namespace pliant::slice {
namespace {

/// A piece of outline from bottom to top.
struct Edge {
    double y0, y1, x0, x1;
    int body, winding;  ///< `winding`: what passing it from left to right adds

    [[nodiscard]] double at(double y) const {
        return y <= y0 ? x0 : y >= y1 ? x1 : x0 + (x1 - x0) * (y - y0) / (y1 - y0);
    }
};

std::vector<Edge> edges_of(std::span<const std::vector<Segment>> outlines) {
    std::vector<Edge> edges;
    for (std::size_t b = 0; b < outlines.size(); ++b) {
        const int body = static_cast<int>(b);
        for (const Segment& s : outlines[b]) {
            // The solid lies to the left of an outline, so to the right of one that runs down.
            if (s.y0 < s.y1) edges.push_back({s.y0, s.y1, s.x0, s.x1, body, -1});
            if (s.y1 < s.y0) edges.push_back({s.y1, s.y0, s.x1, s.x0, body, 1});
        }
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& l, const Edge& r) { return l.y0 < r.y0; });
    return edges;
}

std::vector<double> heights_of(const std::vector<Edge>& edges) {
    std::vector<double> heights;
    for (const Edge& e : edges) {
        heights.push_back(e.y0);
        heights.push_back(e.y1);
    }
    std::sort(heights.begin(), heights.end());
    heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
    return heights;
}

class Sweep {
public:
    explicit Sweep(std::span<const int> material_of) : material_of_(material_of), areas_(material_of.size()) {}

    std::vector<Overlap> over(const std::vector<Edge>& edges) {
        const std::vector<double> heights = heights_of(edges);
        std::size_t next = 0;
        for (std::size_t i = 0; i + 1 < heights.size(); ++i) {
            std::erase_if(active_, [&](const Edge* e) { return e->y1 <= heights[i]; });
            for (; next < edges.size() && edges[next].y0 <= heights[i]; ++next) active_.push_back(&edges[next]);
            if (several_bodies()) band(heights[i], heights[i + 1]);
        }
        return std::move(areas_);
    }

private:
    struct Passing {
        double low, high;  ///< x at the band's bottom and top
        const Edge* edge;
    };

    [[nodiscard]] bool several_bodies() const {
        return std::any_of(active_.begin(), active_.end(), [&](const Edge* e) { return e->body != active_[0]->body; });
    }

    /// Cuts the band where edges cross.
    void band(double bottom, double top) {
        passing_.clear();
        for (const Edge* e : active_) passing_.push_back({e->at(bottom), e->at(top), e});
        std::sort(passing_.begin(), passing_.end(), [](const Passing& l, const Passing& r) {
            return std::pair(l.low, l.high) < std::pair(r.low, r.high);
        });
        const auto higher = [](const Passing& l, const Passing& r) { return l.high < r.high; };
        cuts_.assign(1, bottom);
        if (!std::is_sorted(passing_.begin(), passing_.end(), higher)) {
            for (auto i = passing_.begin(); i != passing_.end(); ++i) {
                for (auto j = i + 1; j != passing_.end(); ++j) {
                    if (j->high >= i->high) continue;
                    const double before = j->low - i->low, after = i->high - j->high;
                    cuts_.push_back(bottom + (top - bottom) * before / (before + after));
                }
            }
            std::sort(cuts_.begin(), cuts_.end());
        }
        cuts_.push_back(top);
        for (std::size_t i = 0; i + 1 < cuts_.size(); ++i) {
            if (cuts_[i + 1] > cuts_[i]) add(cuts_[i], cuts_[i + 1]);
        }
    }

    /// A band without crossings: trapezoids between neighbours, as wide as in their middle.
    void add(double bottom, double top) {
        const double middle = (bottom + top) / 2, height = top - bottom;
        crossed_.clear();
        for (const Edge* e : active_) crossed_.emplace_back(e->at(middle), e);
        std::sort(crossed_.begin(), crossed_.end(), [](const auto& l, const auto& r) { return l.first < r.first; });
        inside_.clear();
        for (std::size_t i = 0; i + 1 < crossed_.size(); ++i) {
            pass(*crossed_[i].second);
            if (inside_.size() > 1) claim((crossed_[i + 1].first - crossed_[i].first) * height);
        }
    }

    void pass(const Edge& edge) {
        const auto place = std::lower_bound(inside_.begin(), inside_.end(), edge.body,
                                            [](const auto& entry, int body) { return entry.first < body; });
        if (place == inside_.end() || place->first != edge.body) {
            inside_.insert(place, {edge.body, edge.winding});
        } else if ((place->second += edge.winding) == 0) {
            inside_.erase(place);
        }
    }

    void claim(double area) {
        const int owner = material_of_[inside_.back().first];
        for (std::size_t i = 0; i + 1 < inside_.size(); ++i) {
            const int body = inside_[i].first;
            (material_of_[body] == owner ? areas_[body].own : areas_[body].others) += area;
        }
    }

    std::span<const int> material_of_;
    std::vector<Overlap> areas_;
    std::vector<const Edge*> active_;
    std::vector<Passing> passing_;
    std::vector<double> cuts_;
    std::vector<std::pair<double, const Edge*>> crossed_;
    std::vector<std::pair<int, int>> inside_;  ///< bodies, with their winding, which is not zero
};

}  // namespace

std::vector<Overlap> overlaps(std::span<const std::vector<Segment>> outlines, std::span<const int> material_of) {
    return Sweep(material_of).over(edges_of(outlines));
}

}  // namespace pliant::slice
