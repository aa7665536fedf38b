#include "printing/slice/outline_clusters.hpp"

#include <algorithm>
#include <limits>

#include "base/core/disjoint_sets.hpp"

namespace pliant::slice {
namespace {

/// Level pieces have a winding of 0: they border nothing, and hold together what is at their ends.
std::vector<Edge> edges_of(std::span<const std::vector<Segment>> outlines) {
    std::vector<Edge> edges;
    for (std::size_t b = 0; b < outlines.size(); ++b) {
        const int body = static_cast<int>(b);
        for (const Segment& s : outlines[b]) {
            if (s.y0 <= s.y1) {
                edges.push_back({s.y0, s.y1, s.x0, s.x1, body, s.y0 < s.y1 ? 1 : 0});
            } else {
                edges.push_back({s.y1, s.y0, s.x1, s.x0, body, -1});
            }
        }
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& l, const Edge& r) { return l.y0 < r.y0; });
    return edges;
}

/// Columns of equal width over all edges, so that an edge is compared only with those near it.
class Columns {
public:
    explicit Columns(const std::vector<Edge>& edges) : edges_(edges) {
        for (const Edge& e : edges) {
            low_ = std::min({low_, e.x0, e.x1});
            high_ = std::max({high_, e.x0, e.x1});
        }
        columns_.resize(std::clamp<std::size_t>(edges.size() / 8, 1, 4096));
    }

    /// Calls visit(other) for earlier edges that reach the height where this one begins, and more than once for some.
    /// Precondition: edges come in the order of their lower ends.
    template <class Visit>
    void add(std::size_t edge, const Visit& visit) {
        const auto [low, high] = std::minmax({edges_[edge].x0, edges_[edge].x1});
        for (std::size_t c = column(low), last = column(high); c <= last; ++c) {
            std::erase_if(columns_[c], [&](std::size_t other) {
                if (edges_[other].y1 < edges_[edge].y0) return true;  // all that follow begin even higher
                visit(other);
                return false;
            });
            columns_[c].push_back(edge);
        }
    }

private:
    [[nodiscard]] std::size_t column(double x) const {
        const double share = high_ > low_ ? (x - low_) / (high_ - low_) : 0;
        return std::min(static_cast<std::size_t>(share * static_cast<double>(columns_.size())), columns_.size() - 1);
    }

    const std::vector<Edge>& edges_;
    double low_ = std::numeric_limits<double>::infinity(), high_ = -std::numeric_limits<double>::infinity();
    std::vector<std::vector<std::size_t>> columns_;
};

bool touch_in_x(const Edge& a, const Edge& b) {
    return std::max(a.x0, a.x1) >= std::min(b.x0, b.x1) && std::max(b.x0, b.x1) >= std::min(a.x0, a.x1);
}

/// Each edge's cluster, numbered from 0 by their first edges: edges whose boxes touch are of the same.
std::vector<std::size_t> cluster_of(const std::vector<Edge>& edges) {
    DisjointSets sets(edges.size());
    Columns columns(edges);
    for (std::size_t e = 0; e < edges.size(); ++e) {
        columns.add(e, [&](std::size_t other) {
            if (touch_in_x(edges[e], edges[other])) sets.join(static_cast<int>(e), static_cast<int>(other));
        });
    }
    std::vector<std::size_t> number(edges.size());
    std::size_t count = 0;
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const auto first = static_cast<std::size_t>(sets.find(static_cast<int>(e)));
        number[e] = first == e ? count++ : number[first];
    }
    return number;
}

/// A place on an edge of each cluster that has any, by height.
struct Probe {
    double x, y;
    std::size_t cluster;
};

std::vector<Probe> probes_of(const std::vector<Cluster>& clusters) {
    std::vector<Probe> probes;
    for (std::size_t i = 0; i < clusters.size(); ++i) {
        if (clusters[i].edges.empty()) continue;
        const Edge& edge = clusters[i].edges[0];
        const double y = (edge.y0 + edge.y1) / 2;
        probes.push_back({edge.at(y), y, i});
    }
    std::sort(probes.begin(), probes.end(), [](const Probe& l, const Probe& r) { return l.y < r.y; });
    return probes;
}

/// The winding numbers around a cluster are those to the left of a place on it, due to the others. `number`: of each
/// edge's cluster.
void look_around(const std::vector<Edge>& edges, const std::vector<std::size_t>& number,
                 std::vector<Cluster>& clusters) {
    std::vector<std::size_t> active;
    std::size_t next = 0;
    for (const Probe& probe : probes_of(clusters)) {
        std::erase_if(active, [&](std::size_t e) { return edges[e].y1 <= probe.y; });
        for (; next < edges.size() && edges[next].y0 <= probe.y; ++next) {
            if (edges[next].y1 > probe.y) active.push_back(next);
        }
        for (const std::size_t e : active) {
            if (number[e] != probe.cluster && edges[e].at(probe.y) < probe.x)
                pass(clusters[probe.cluster].around, edges[e]);
        }
    }
}

}  // namespace

void pass(Windings& inside, const Edge& edge) {
    const auto place = std::lower_bound(inside.begin(), inside.end(), edge.body,
                                        [](const auto& entry, int body) { return entry.first < body; });
    if (place == inside.end() || place->first != edge.body) {
        inside.insert(place, {edge.body, edge.winding});
    } else if ((place->second += edge.winding) == 0) {
        inside.erase(place);
    }
}

std::vector<Cluster> clusters_of(std::span<const std::vector<Segment>> outlines) {
    const std::vector<Edge> edges = edges_of(outlines);
    const std::vector<std::size_t> number = cluster_of(edges);
    std::vector<Cluster> clusters(number.empty() ? 0 : *std::max_element(number.begin(), number.end()) + 1);
    for (std::size_t e = 0; e < edges.size(); ++e) {
        if (edges[e].winding != 0) clusters[number[e]].edges.push_back(edges[e]);
    }
    if (clusters.size() > 1) look_around(edges, number, clusters);
    std::erase_if(clusters, [](const Cluster& c) { return c.edges.empty(); });  // level throughout: it encloses nothing
    return clusters;
}

}  // namespace pliant::slice
