// FieldLevels against Cholesky, on lattices of springs; the estimate of a factor's size against its analysis.
#include "base/linalg/field_levels.hpp"

#include <doctest/doctest.h>
#include <tbb/global_control.h>

#include <array>
#include <cmath>
#include <thread>
#include <vector>

#include "base/core/near.hpp"
#include "base/linalg/cholesky.hpp"
#include "base/linalg/factor_size.hpp"

using namespace pliant;
using namespace pliant::linalg;

namespace {

struct ScalarProblem {
    SymmetricPattern pattern;
    std::vector<double> values;
    Nesting corners;

    [[nodiscard]] double energy(std::span<const double> field) const {
        double sum = 0;
        const auto nodes = static_cast<std::size_t>(pattern.nodes);
        std::vector<double> one(nodes), force(nodes);
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t i = 0; i < nodes; ++i) one[i] = field[3 * i + c];
            std::fill(force.begin(), force.end(), 0.0);
            add_product(pattern, values, one, 1, force);
            for (std::size_t i = 0; i < nodes; ++i) sum += one[i] * force[i];
        }
        return sum;
    }
};

struct Spring {
    int a, b;
    double stiffness;
};

ScalarProblem of_springs(int nodes, const std::vector<Spring>& springs, int held) {
    ScalarProblem p;
    std::vector<std::vector<int>> cliques;
    for (const Spring& s : springs) cliques.push_back({s.a, s.b});
    p.pattern = make_pattern(nodes, 1, cliques);
    p.values.assign(p.pattern.entries(), 0.0);
    const auto add = [&](int i, int j, double value) {
        p.values[static_cast<std::size_t>(p.pattern.find(std::max(i, j), std::min(i, j)))] += value;
    };
    for (const Spring& s : springs) {
        add(s.a, s.a, s.stiffness);
        add(s.b, s.b, s.stiffness);
        add(s.a, s.b, -s.stiffness);
    }
    for (int i = 0; i < held; ++i) add(i, i, 1);
    return p;
}

/// Springs along the edges of unit cells, a thousand times stiffer in the second half, held at one end; with
/// `mid_nodes`, two in a row and one beside them.
ScalarProblem lattice(int along, int across, bool mid_nodes) {
    const int side = across + 1, corners = (along + 1) * side * side;
    const auto node = [&](int i, int j, int k) { return (i * side + j) * side + k; };
    std::vector<Spring> springs;
    Nesting nesting{corners, {}};
    for (int i = 0; i < corners; ++i) nesting.ends.push_back({i, i});
    for (int i = 0; i <= along; ++i) {
        for (int j = 0; j < side; ++j) {
            for (int k = 0; k < side; ++k) {
                for (const auto& [di, dj, dk] : {std::array{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {0, 1, 1}}) {
                    if (i + di > along || j + dj >= side || k + dk >= side) continue;
                    const int a = node(i, j, k), b = node(i + di, j + dj, k + dk);
                    const double stiffness = 2 * i < along ? 1 : 1000;
                    springs.push_back({a, b, stiffness});
                    if (!mid_nodes) continue;
                    const int middle = static_cast<int>(nesting.ends.size());
                    nesting.ends.push_back({a, b});
                    springs.push_back({a, middle, 2 * stiffness});
                    springs.push_back({middle, b, 2 * stiffness});
                }
            }
        }
    }
    ScalarProblem p = of_springs(static_cast<int>(nesting.ends.size()), springs, side * side);
    p.corners = std::move(nesting);
    return p;
}

/// Smooth and rough forces, (count, nodes, 3).
std::vector<double> forces_on(int nodes, int count) {
    std::vector<double> fields;
    for (int i = 0; i < 3 * nodes * count; ++i) fields.push_back(1e-3 + std::sin(0.7 * i) * std::cos(1e-3 * i * i));
    return fields;
}

}  // namespace

TEST_CASE("fields on levels have the asked error in the energy norm, after few iterations") {
    struct Case {
        ScalarProblem problem;
        bool nested;
    };
    for (const Case& c : {Case{lattice(40, 24, false), false}, {lattice(24, 16, true), true}}) {
        CAPTURE(c.nested);
        const ScalarProblem& p = c.problem;
        REQUIRE(p.pattern.nodes > 22000);  // more than one level
        FieldLevels levels(p.pattern, p.values, c.nested ? &p.corners : nullptr);
        Cholesky factor(p.pattern);
        REQUIRE(factor.factorise(p.values));
        std::vector<double> exact = forces_on(p.pattern.nodes, 1);
        factor.solve_fields(exact, 1);
        for (const double tolerance : {1e-2, 1e-5}) {
            std::vector<double> found = forces_on(p.pattern.nodes, 1);
            const int iterations = levels.solve(found, 1, tolerance);
            CHECK(iterations > 1);
            CHECK(iterations < 30);
            for (std::size_t i = 0; i < found.size(); ++i) found[i] -= exact[i];
            CHECK(std::sqrt(p.energy(found) / p.energy(exact)) < 2 * tolerance);
        }
    }
}

TEST_CASE("several fields are solved as each one alone, with the same bits on any number of threads") {
    const ScalarProblem p = lattice(40, 24, false);
    const auto solved = [&](std::size_t threads, int count) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        FieldLevels levels(p.pattern, p.values);
        std::vector<double> fields = forces_on(p.pattern.nodes, count);
        levels.solve(fields, count, 1e-4);
        return fields;
    };
    const std::vector<double> both = solved(4, 2), one = solved(1, 1);
    CHECK(std::equal(one.begin(), one.end(), both.begin()));
    CHECK(solved(1, 2) == both);
    // From several threads at once.
    const FieldLevels shared(p.pattern, p.values);
    std::vector<std::vector<double>> each(4, forces_on(p.pattern.nodes, 1));
    {
        std::vector<std::jthread> threads;
        for (std::vector<double>& field : each)
            threads.emplace_back([&shared, &field] { shared.solve(field, 1, 1e-4); });
    }
    for (const std::vector<double>& field : each) CHECK(field == one);
}

TEST_CASE("no force, no motion; nodes without neighbours move by their own stiffness") {
    const ScalarProblem p = lattice(40, 24, false);
    FieldLevels levels(p.pattern, p.values);
    std::vector<double> nothing(3 * static_cast<std::size_t>(p.pattern.nodes), 0.0);
    CHECK(levels.solve(nothing, 1, 1e-5) == 0);
    CHECK(nothing == std::vector<double>(nothing.size(), 0.0));

    constexpr int alone = 30000;
    const ScalarProblem loose = of_springs(alone, {}, alone);
    FieldLevels each(loose.pattern, loose.values);
    std::vector<double> fields(std::size_t{3} * alone, 2.5);
    each.solve(fields, 1, 1e-5);
    for (const double x : fields) REQUIRE(x == near(2.5, {.relative = 1e-5}));
}

TEST_CASE("the estimated size of a factor is near that of its analysis, for bulky, slender and flat bodies") {
    for (const auto& [along, across] : {std::pair{30, 24}, {2000, 3}, {3, 80}}) {
        CAPTURE(along);
        const ScalarProblem p = lattice(along, across, false);
        const FactorSize size = estimate_factor_size(p.pattern);
        const Cholesky factor(p.pattern);
        CHECK(size.entries > factor.factor_entries() / 2);
        CHECK(size.entries < factor.factor_entries() * 2);
        CHECK(size.work > factor.factor_work() / 3);
        CHECK(size.work < factor.factor_work() * 3);
    }
}
