#include "simulation/contact/clearance.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "simulation/contact/distance.hpp"
#include "simulation/contact/test_bodies.hpp"

using namespace pliant;
using namespace pliant::sim::contact;

namespace {

constexpr double contact_reach = 0.05, seen = 0.4;

struct FeaturePair {
    std::vector<int> first, second;  ///< nodes
    [[nodiscard]] double distance(std::span<const double> x) const {
        const Stencil at{node_at(x, first[0]), node_at(x, first.size() > 1 ? first[1] : second[0]),
                         node_at(x, second[second.size() - 2]), node_at(x, second.back())};
        return std::sqrt(squared_distance(first.size() > 1 ? nearest_edges(at) : nearest_point_triangle(at), at));
    }
};

/// All pairs of features that share no node.
std::vector<FeaturePair> all_features(const Surface& s) {
    std::vector<FeaturePair> all;
    for (const int p : s.points)
        for (const auto& t : s.triangles)
            if (std::count(t.begin(), t.end(), p) == 0) all.push_back({{p}, {t.begin(), t.end()}});
    for (std::size_t e = 0; e < s.edges.size(); ++e)
        for (std::size_t g = e + 1; g < s.edges.size(); ++g)
            if (std::count(s.edges[g].begin(), s.edges[g].end(), s.edges[e][0]) +
                    std::count(s.edges[g].begin(), s.edges[g].end(), s.edges[e][1]) ==
                0)
                all.push_back({{s.edges[e].begin(), s.edges[e].end()}, {s.edges[g].begin(), s.edges[g].end()}});
    return all;
}

/// Two bars side by side, 0.5 apart.
struct Bars {
    SpringBody body = spring_box({0, 0, 0}, {6, 1, 1}, {9, 2, 2});
    Surface surface;
    std::shared_ptr<const Regions> regions;
    std::vector<FeaturePair> features;

    Bars() {
        body.add(spring_box({0, 1.5, 0}, {6, 1, 1}, {9, 2, 2}));
        surface = make_surface(body.triangles);
        regions = std::make_shared<const Regions>(surface, body.rest);
        features = all_features(surface);
    }
    [[nodiscard]] Clearance clearance(std::span<const double> x) const {
        const std::array<Clearance::Side, 1> sides{{{&surface, regions}}};
        const std::array<Clearance::Meeting, 1> meetings{{{0, 0}}};
        Clearance clearance(sides, meetings, x, seen, contact_reach);
        for (const FeaturePair& f : features) {
            const double apart = f.distance(x);
            if (apart < seen) clearance.offer(0, f.first, f.second, apart, contact_reach);
        }
        return clearance;
    }
    [[nodiscard]] double smallest_distance(std::span<const double> x) const {
        double smallest = HUGE_VAL;
        for (const FeaturePair& f : features) smallest = std::min(smallest, f.distance(x));
        return smallest;
    }
    /// `bend` radians from end to end, each bar by itself if `apart`, then turned by `turn` about x.
    [[nodiscard]] std::vector<double> bent(double bend, double turn, bool apart = false) const {
        std::vector<double> x(body.rest.size());
        for (std::size_t i = 0; i < x.size(); i += 3) {
            const bool second = body.rest[i + 1] > 1.25;
            const double angle = bend * body.rest[i] / 6 * (apart && second ? -1 : 1);
            const double off = body.rest[i + 1], up = body.rest[i + 2];
            const double along = std::fabs(angle) > 1e-12 ? body.rest[i] * std::sin(angle) / angle : body.rest[i];
            const double side = std::fabs(angle) > 1e-12 ? body.rest[i] * (1 - std::cos(angle)) / angle : 0;
            const double px = along - off * std::sin(angle), py = side + off * std::cos(angle);
            x[i] = px;
            x[i + 1] = std::cos(turn) * py - std::sin(turn) * up;
            x[i + 2] = std::sin(turn) * py + std::cos(turn) * up;
        }
        return x;
    }
};

std::vector<double> minus(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> d(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) d[i] = a[i] - b[i];
    return d;
}

}  // namespace

TEST_CASE("a clearance holds for small motions, bending and rigid rotation, and ends before contact") {
    const Bars bars;
    const Clearance clearance = bars.clearance(bars.body.rest);
    CHECK(clearance.holds(bars.body.rest, {}));
    CHECK(clearance.holds(bars.bent(0.1, 0), {}));
    CHECK(clearance.holds(bars.bent(0, 0.2), {}));
    CHECK(clearance.holds(bars.body.rest, minus(bars.bent(0.1, 0.1), bars.body.rest)));
    // The bars bend towards each other by some 0.45 each: they meet.
    const auto met = bars.bent(0.3, 0, true);
    CHECK_FALSE(clearance.holds(met, {}));
    CHECK_FALSE(clearance.holds(bars.body.rest, minus(met, bars.body.rest)));
    // There and back: the end is clear, the path is not.
    std::vector<double> past = bars.body.rest, through = bars.body.rest;
    for (std::size_t i = 1; i < past.size(); i += 3)
        if (bars.body.rest[i] > 1.25) past[i] += 4, through[i] -= 4;
    CHECK_FALSE(clearance.holds(past, minus(through, past)));
    CHECK_FALSE(clearance.holds(std::vector<double>(past.size(), std::nan("")), {}));
}

TEST_CASE("while a clearance holds, no feature comes within reach or to a tenth of its former distance") {
    const Bars bars;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(-1, 1);
    int held = 0;
    for (int trial = 0; trial < 60; ++trial) {
        const double size = std::pow(10, -2.5 + 2 * trial / 60.0);
        const auto from = bars.bent(0.3 * uniform(random), uniform(random));
        const Clearance clearance = bars.clearance(from);
        std::vector<double> x = from, dx(from.size());
        for (std::size_t i = 0; i < x.size(); ++i) {
            x[i] += 0.3 * size * uniform(random);
            dx[i] = size * (uniform(random) + (i % 3 == 1 ? (bars.body.rest[i] > 1.25 ? -3 : 3) : 0));
        }
        if (!clearance.holds(x, dx)) continue;
        ++held;
        std::vector<double> at = x;
        for (int k = 0; k <= 4; ++k) {
            for (std::size_t i = 0; i < at.size(); ++i) at[i] = x[i] + 0.25 * k * dx[i];
            CHECK(bars.smallest_distance(at) > contact_reach);
            CHECK(clearance.holds(at, {}));
        }
    }
    CHECK(held > 20);
    CHECK(held < 55);  // otherwise nothing ever came near
}
