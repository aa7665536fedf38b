#include "simulation/contact/contact.hpp"

#include <doctest/doctest.h>
#include <tbb/global_control.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/core/near.hpp"
#include "simulation/contact/test_bodies.hpp"
#include "simulation/contact/test_derivatives.hpp"

using namespace pliant;
using namespace pliant::sim::contact;

namespace {

using Vector = Eigen::VectorXd;

Vector vector_of(const std::vector<double>& x) {
    return Eigen::Map<const Vector>(x.data(), static_cast<Eigen::Index>(x.size()));
}

std::span<const double> span(const Vector& x) {
    return {x.data(), static_cast<std::size_t>(x.size())};
}

/// Two boxes of 1 cm, one above the other with a gap of 2 mm, shifted against each other so that all kinds of pairs
/// occur.
SpringBody two_boxes(int cells) {
    SpringBody body = spring_box({0, 0, 0}, {0.01, 0.01, 0.01}, {cells, cells, cells}, 0.1);
    body.add(spring_box({0.0013, 0.0021, 0.012}, {0.008, 0.0085, 0.01}, {cells, cells + 1, cells}, 0.15));
    return body;
}

Contact contact_of(const SpringBody& body, const Settings& settings, std::vector<Obstacle> obstacles = {}) {
    auto contact = Contact::create(make_surface(body.triangles), std::move(obstacles), settings, body.rest);
    REQUIRE_MESSAGE(contact.has_value(), (contact ? "" : contact.error().message));
    return *contact;
}

constexpr Settings usual{.distance_m = 1e-3, .stiffness_Pa = 1e4, .friction = 0, .slip_m = 1e-5, .self = true};

/// A state in which the upper box has moved down by `drop` and every node is slightly perturbed.
Vector approached(const Contact& contact, std::size_t lower_nodes, double drop, double noise, unsigned seed) {
    Vector x = vector_of(contact.rest());
    std::mt19937 random(seed);
    for (Eigen::Index i = 0; i < x.size() / 3; ++i) {
        const Vec3 shift = noise * random_vector(random);
        x.segment<3>(3 * i) += Eigen::Vector3d(shift.x, shift.y, shift.z);
        if (i >= static_cast<Eigen::Index>(lower_nodes)) x[3 * i + 2] -= drop;
    }
    return x;
}

/// Solves for the intersection of the line through a and b with the triangle's plane: independent of the library's
/// method.
bool crosses(const Vec3& a, const Vec3& b, const Vec3& t0, const Vec3& t1, const Vec3& t2) {
    const auto e = [](const Vec3& v) { return Eigen::Vector3d(v.x, v.y, v.z); };
    Eigen::Matrix3d M;
    M << e(a - b), e(t1 - t0), e(t2 - t0);
    if (std::abs(M.determinant()) < 1e-30) return false;
    const Eigen::Vector3d s = M.inverse() * e(a - t0);
    return s[0] > 0 && s[0] < 1 && s[1] > 0 && s[2] > 0 && s[1] + s[2] < 1;
}

int brute_force_crossings(const Surface& surface, std::span<const double> x) {
    int count = 0;
    for (const auto& e : surface.edges)
        for (const auto& t : surface.triangles) {
            if (std::find(t.begin(), t.end(), e[0]) != t.end() || std::find(t.begin(), t.end(), e[1]) != t.end())
                continue;
            count += crosses(node_at(x, e[0]), node_at(x, e[1]), node_at(x, t[0]), node_at(x, t[1]), node_at(x, t[2]));
        }
    return count;
}

using Key = std::tuple<bool, int, int, int, int>;

Key key_of(bool edges, std::array<int, 4> n) {
    if (edges && n[0] > n[2]) n = {n[2], n[3], n[0], n[1]};
    return {edges, n[0], n[1], n[2], n[3]};
}

/// The pairs that are closer than `limit` of their distance at rest.
template <class Limit>
std::vector<Key> brute_force_pairs(const Surface& s, std::span<const double> rest, std::span<const double> x,
                                   const Limit& limit) {
    std::vector<Key> found;
    const auto offer = [&](Features features, const std::array<int, 4>& n) {
        const auto apart = [&](std::span<const double> at) {
            const Stencil p{node_at(at, n[0]), node_at(at, n[1]), node_at(at, n[2]), node_at(at, n[3])};
            return std::sqrt(squared_distance(nearest(features, p), p));
        };
        if (apart(x) < limit(apart(rest))) found.push_back(key_of(features == Features::edge_edge, n));
    };
    for (const int p : s.points)
        for (const auto& t : s.triangles)
            if (std::find(t.begin(), t.end(), p) == t.end()) offer(Features::point_triangle, {p, t[0], t[1], t[2]});
    for (std::size_t a = 0; a < s.edges.size(); ++a)
        for (std::size_t b = a + 1; b < s.edges.size(); ++b) {
            const auto &e = s.edges[a], &g = s.edges[b];
            if (e[0] != g[0] && e[0] != g[1] && e[1] != g[0] && e[1] != g[1])
                offer(Features::edge_edge, {e[0], e[1], g[0], g[1]});
        }
    std::sort(found.begin(), found.end());
    return found;
}

}  // namespace

TEST_CASE("at rest, and after a rigid motion, there is no contact, for any contact distance") {
    const SpringBody body = two_boxes(4);
    Settings far = usual;
    far.distance_m = 0.01;
    const Contact contact = contact_of(body, far);
    CHECK(contact.find(contact.rest()).empty());
    std::mt19937 random(2);
    const Motion motion = random_motion(random);
    std::vector<double> x;
    for (int i = 0; i < contact.node_count(); ++i) {
        const Vec3 p = motion(node_at(contact.rest(), i));
        x.insert(x.end(), {p.x, p.y, p.z});
    }
    CHECK(contact.find(x).empty());
    CHECK(contact.energy({}, x) == 0);
    CHECK(std::isinf(contact.smallest_distance({}, x)));
}

TEST_CASE("two pieces keep one reach, half the gap between them, wherever they slide on each other") {
    SpringBody body = spring_box({0, 0, 0}, {0.02, 0.01, 0.005}, {8, 4, 2}, 0.1);
    const auto lower = static_cast<Eigen::Index>(body.node_count());
    body.add(spring_box({0.002, 0.002, 0.0054}, {0.005, 0.006, 0.005}, {2, 3, 2}, 0.15));
    const Contact contact = contact_of(body, usual);
    CHECK(contact.find(contact.rest()).empty());
    for (const double slid : {0.0, 0.003, 0.01}) {
        Vector x = vector_of(contact.rest());
        for (Eigen::Index i = lower; i < x.size() / 3; ++i) x.segment<3>(3 * i) += Eigen::Vector3d(slid, 0, -0.3e-3);
        const Pairs pairs = contact.find(span(x));
        CHECK(pairs.size() > 5);
        for (const Pair& pair : pairs) CHECK(pair.reach_m == near(0.2e-3, {.relative = 1e-9}));
    }
}

TEST_CASE("the contact pairs agree with a search over all features") {
    const SpringBody body = two_boxes(4);
    const Contact contact = contact_of(body, usual);
    const Surface surface = make_surface(body.triangles);
    for (const double drop : {1.2e-3, 1.6e-3, 1.9e-3}) {
        const Vector x = approached(contact, 125, drop, 5e-5, 4);
        const auto keys_of = [](const Pairs& pairs) {
            std::vector<Key> keys;
            for (const Pair& pair : pairs) keys.push_back(key_of(pair.kind == PairKind::edge_edge, pair.nodes));
            std::sort(keys.begin(), keys.end());
            return keys;
        };
        const auto within_reach = [](double at_rest) { return std::min(usual.distance_m, 0.5 * at_rest); };
        const std::vector<Key> found = keys_of(contact.find(span(x)));
        CHECK(found.size() > 50);
        CHECK(found == brute_force_pairs(surface, contact.rest(), span(x), within_reach));
        // Features of one box are near each other at rest, and belong together; those of both were two boxes apart.
        std::vector<Key> near_by = keys_of(contact.find_near(span(x), 2 * usual.distance_m));
        CHECK(near_by.size() > found.size());
        CHECK(std::includes(near_by.begin(), near_by.end(), found.begin(), found.end()));
        for (const Key& key : brute_force_pairs(surface, contact.rest(), span(x), [](double at_rest) {
                 return at_rest > 4 * usual.distance_m ? 2 * usual.distance_m : 0;
             }))
            CHECK(std::binary_search(near_by.begin(), near_by.end(), key));
    }
}

TEST_CASE("gradient and Hessian of the whole potential agree with finite differences") {
    const SpringBody body = two_boxes(2);
    const Contact contact = contact_of(body, usual);
    const Vector x = approached(contact, 27, 1.7e-3, 5e-5, 9);
    const auto energy = [&](const Vector& y) { return contact.energy(contact.find(span(y)), span(y)); };
    const auto gradient = [&](const Vector& y) {
        Vector g = Vector::Zero(y.size());
        contact.add_gradient(contact.find(span(y)), span(y), {g.data(), static_cast<std::size_t>(g.size())});
        return g;
    };
    const Vector g = gradient(x);
    REQUIRE(g.norm() > 0);
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(x.size(), x.size());
    contact.visit_hessian(contact.find(span(x)), span(x), false,
                          [&](int i, int j, const linalg::Matrix3& b) { H.block<3, 3>(3 * i, 3 * j) += b; });
    const double h = 1e-9;
    for (Eigen::Index k = 0; k < x.size(); ++k) {
        Vector forth = x, back = x;
        forth[k] += h;
        back[k] -= h;
        CHECK(std::abs(g[k] - (energy(forth) - energy(back)) / (2 * h)) < 1e-5 * g.norm());
        CHECK((H.col(k) - (gradient(forth) - gradient(back)) / (2 * h)).norm() < 1e-4 * H.norm());
    }
    CHECK((H - H.transpose()).norm() < 1e-12 * H.norm());
}

TEST_CASE("steps of any size never let surfaces pass through each other") {
    const SpringBody body = two_boxes(3);
    const Contact contact = contact_of(body, usual);
    const Surface surface = make_surface(body.triangles);
    std::mt19937 random(8);
    int hindered = 0;
    for (int k = 0; k < 40; ++k) {
        const Vector x = approached(contact, 64, 1.5e-3, 1e-5, 20 + k);
        Vector dx(x.size());
        for (Eigen::Index i = 0; i < x.size() / 3; ++i) {
            const Vec3 v = 0.003 * random_vector(random) + (i < 64 ? Vec3{} : Vec3{0, 0, -0.002 * (k % 4)});
            dx.segment<3>(3 * i) << v.x, v.y, v.z;
        }
        const double step = contact.largest_step(span(x), span(dx));
        CHECK(step > 0);
        for (int s = 1; s <= 5; ++s) REQUIRE(brute_force_crossings(surface, span(Vector(x + s * step / 5 * dx))) == 0);
        const Vector full = x + dx;
        if (brute_force_crossings(surface, span(full)) == 0) continue;
        ++hindered;
        CHECK(step < 1);
        CHECK(contact.crossing(span(full)).has_value());
    }
    CHECK(hindered > 10);
}

TEST_CASE("cached data change nothing: pairs and steps equal those of a new contact") {
    const SpringBody body = two_boxes(4);
    const Contact contact = contact_of(body, usual);
    const auto check_pairs = [&](const Vector& x) {
        const Pairs found = contact.find(span(x)), expected = contact_of(body, usual).find(span(x));
        REQUIRE(found.size() == expected.size());
        for (std::size_t k = 0; k < found.size(); ++k) {
            CHECK(found[k].nodes == expected[k].nodes);
            CHECK(found[k].kind == expected[k].kind);
            CHECK(found[k].reach_m == expected[k].reach_m);
        }
        return found.size();
    };
    std::mt19937 random(12);
    std::size_t pairs = 0;
    for (int k = 0; k < 90; ++k) {
        // First clear of each other, then mostly near the last state, sometimes far from it, and back.
        const double drop = k < 30 ? 4e-5 * k : 1.5e-3 + (k % 9 == 8 ? 4e-4 : 0) + 5e-6 * (k - 30);
        const Vector x = approached(contact, 125, drop, k % 9 == 5 ? 3e-4 : 2e-5, 30 + k);
        pairs += check_pairs(x);
        Vector dx(x.size());
        const double far = k % 3 == 0 ? 2e-3 : 1e-4;
        for (Eigen::Index i = 0; i < x.size() / 3; ++i) {
            const Vec3 v = far * random_vector(random);
            dx.segment<3>(3 * i) << v.x, v.y, v.z;
        }
        const double step = contact_of(body, usual).largest_step(span(x), span(dx));
        CHECK(contact.largest_step(span(x), span(dx)) == step);
        CHECK(contact.is_free(span(x), span(dx)) == (step == 1));
        const Vector far_beyond = 1e6 * dx;
        const double early = contact.largest_step(span(x), span(far_beyond));
        const double blocked = 1e6 * early;  // in units of dx
        if (early < 1)
            CHECK(2 * contact.largest_step(span(x), span(Vector(2 * blocked * dx))) == near(1, {.relative = 0.02}));
        CHECK(contact.meets(span(x), span(dx)) == (step < 1));
        check_pairs(x + 0.3 * dx);
    }
    CHECK(pairs > 1000);
}

TEST_CASE("a cube let down on a plane rests above it and presses with its weight") {
    const SpringBody body = spring_box({0, 0, 0.003}, {0.01, 0.01, 0.01}, {2, 2, 2});
    const HalfSpace floor{{0, 0, 0}, {0, 0, 2}};
    mesh::TriMesh table{{{-0.02, -0.03, 0}, {0.05, -0.03, 0}, {0.04, 0.05, 0}, {-0.02, 0.04, 0}},
                        {{0, 1, 2}, {0, 2, 3}}};
    for (const Obstacle& obstacle : {Obstacle{"floor", floor, 0.3}, Obstacle{"table", table, 0.3}}) {
        CAPTURE(obstacle.name);
        const Contact contact = contact_of(body, usual, {obstacle});
        const std::size_t n = body.node_count();
        const double weight = 0.027;
        Statics statics{&body,
                        50,
                        &contact,
                        std::vector<double>(3 * n),
                        std::vector<double>(n),
                        body.rest,
                        std::vector<bool>(static_cast<std::size_t>(contact.node_count()))};
        for (std::size_t i = 0; i < n; ++i) statics.load[3 * i + 2] = -weight / static_cast<double>(n);
        for (std::size_t i = n; i < statics.held.size(); ++i) statics.held[i] = true;
        Vector x = vector_of(contact.rest());
        // Without friction its position on the table is undetermined, so only nearly to equilibrium; then friction
        // holds it.
        REQUIRE(statics.minimise(x, nullptr, 2e-6) > 0);
        const Vector landed = x;
        const Friction friction = contact.freeze(contact.find(span(x)), span(x), span(landed));
        REQUIRE(statics.minimise(x, &friction, 1e-9) > 0);

        const Pairs pairs = contact.find(span(x));
        const Forces forces = contact.forces(pairs, span(x), &friction);
        CHECK(forces.smallest_distance_m > 0);
        CHECK(forces.smallest_distance_m < usual.distance_m);
        CHECK(norm(forces.on_robot_N[0] - Vec3{0, 0, weight}) < 1e-6 * weight);
        CHECK(forces.self_N == 0);
        CHECK(x.minCoeff() < 0.001);
        // Mean pressure under the cube: weight over its 1 cm² base.
        double carried = 0;
        const SurfaceAreas areas = surface_areas(make_surface(body.triangles), body.rest);
        for (std::size_t i = 0; i < areas.points.size(); ++i)
            carried += forces.pressure_Pa[make_surface(body.triangles).points[i]] * areas.points[i];
        CHECK(carried == near(weight, {.relative = 0.01}));
    }
}

TEST_CASE("two boxes pressed together never intersect") {
    const SpringBody body = two_boxes(3);
    const Contact contact = contact_of(body, usual);
    const Surface surface = make_surface(body.triangles);
    const std::size_t n = body.node_count();
    Statics statics{
        &body, 50, &contact, std::vector<double>(3 * n), std::vector<double>(n), body.rest, std::vector<bool>(n)};
    std::vector<bool> pushed(n);
    for (std::size_t i = 0; i < n; ++i) {
        const double z = body.rest[3 * i + 2];
        pushed[i] = z > 0.0219;
        statics.held[i] = z < 1e-4 || pushed[i];
    }
    Vector x = vector_of(contact.rest());
    const auto look = [&](const Vector& y) { REQUIRE(brute_force_crossings(surface, span(y)) == 0); };
    double moved = 0;
    for (int k = 0; k < 200 && moved < 0.006 - 1e-12; ++k) {
        Vector dx = Vector::Zero(x.size());
        const double push = std::min(5e-4, 0.006 - moved);
        for (std::size_t i = 0; i < n; ++i)
            if (pushed[i]) dx[3 * static_cast<Eigen::Index>(i) + 2] = -push;
        const double step = contact.largest_step(span(x), span(dx));
        x += step * dx;
        moved += step * push;
        REQUIRE(statics.minimise(x, nullptr, 1e-7, look) >= 0);
    }
    CHECK(moved == near(0.006, {.relative = 1e-12}));
    const Forces forces = contact.forces(contact.find(span(x)), span(x), nullptr);
    CHECK(forces.smallest_distance_m > 0);
    CHECK(forces.self_N > 0.05);
    CHECK_FALSE(contact.crossing(span(x)).has_value());
}

namespace {

/// The motion of a block down an incline of 30 degrees: the mean acceleration and the last step's slip.
struct Slide {
    double acceleration, last_step_m;
};

Slide slide_down(double friction) {
    const double g = 9.81, angle = M_PI / 6, dt = 0.01, mass = 0.001;
    const SpringBody body = spring_box({0, 0, 2e-4}, {0.01, 0.01, 0.005}, {2, 2, 1});
    Settings settings = usual;
    settings.slip_m = 1e-6;
    const Contact contact = contact_of(body, settings, {{"incline", HalfSpace{{0, 0, 0}, {0, 0, 1}}, friction}});
    const std::size_t n = body.node_count();
    const double node_mass = mass / static_cast<double>(n);
    Statics statics{&body,
                    500,
                    &contact,
                    std::vector<double>(3 * n),
                    std::vector<double>(n, node_mass / (dt * dt)),
                    body.rest,
                    std::vector<bool>(n + 1)};
    statics.held[n] = true;
    for (std::size_t i = 0; i < n; ++i) {
        statics.load[3 * i] = node_mass * g * std::sin(angle);
        statics.load[3 * i + 2] = -node_mass * g * std::cos(angle);
    }
    Vector x = vector_of(contact.rest()), before = x;
    std::vector<double> place;
    for (int step = 0; step < 40; ++step) {
        // Backward Euler: inertia about the position without forces.
        const Vector predicted = 2 * x - before, start = x;
        statics.predicted.assign(predicted.data(), predicted.data() + 3 * n);
        for (int lag = 0; lag < 4; ++lag) {
            const Friction held = contact.freeze(contact.find(span(x)), span(x), span(start));
            REQUIRE(statics.minimise(x, &held, 1e-9) >= 0);
        }
        before = start;
        double mean = 0;
        for (std::size_t i = 0; i < n; ++i) mean += x[3 * static_cast<Eigen::Index>(i)] / static_cast<double>(n);
        place.push_back(mean);
    }
    const auto speed = [&](std::size_t k) { return (place[k] - place[k - 1]) / dt; };
    return {(speed(39) - speed(19)) / (20 * dt), place[39] - place[38]};
}

}  // namespace

TEST_CASE("a block on an incline sticks if friction suffices, and otherwise accelerates as Coulomb says") {
    const double steep = std::tan(M_PI / 6);
    const Slide stuck = slide_down(1.2 * steep);
    CHECK(std::abs(stuck.last_step_m) < 1e-6);
    CHECK(std::abs(stuck.acceleration) < 1e-3);
    for (const double share : {0.0, 0.4, 0.8}) {
        const Slide sliding = slide_down(share * steep);
        CHECK(sliding.acceleration == near(9.81 * 0.5 * (1 - share), {.relative = 0.01}));
    }
}

TEST_CASE("an obstacle that slides along the robot pulls it in the direction of its motion") {
    const SpringBody body = spring_box({0, 0, 5e-4}, {0.01, 0.01, 0.005}, {2, 2, 1});
    mesh::TriMesh table{{{-0.02, -0.03, 0}, {0.05, -0.03, 0}, {0.04, 0.05, 0}}, {{0, 1, 2}}};
    const Contact contact = contact_of(body, usual, {{"table", table, 0.5}});
    CHECK(contact.first_node(0) == contact.robot_node_count());
    CHECK(contact.first_node(1) == contact.node_count());
    Vector x = vector_of(contact.rest());
    for (int i = contact.first_node(0); i < contact.first_node(1); ++i) x[3 * i + 2] += 4e-4;
    const Vector start = x;
    for (int i = contact.first_node(0); i < contact.first_node(1); ++i) x[3 * i] += 1e-3;
    const Pairs pairs = contact.find(span(x));
    const Friction friction = contact.freeze(pairs, span(x), span(start));
    const Vec3 pressed = contact.forces(pairs, span(x), nullptr).on_robot_N[0];
    const Vec3 all = contact.forces(pairs, span(x), &friction).on_robot_N[0];
    CHECK(pressed.z > 0);
    CHECK(std::abs(pressed.x) < 1e-9 * pressed.z);
    CHECK(all.x == near(0.5 * pressed.z, {.relative = 1e-12}));
    CHECK(all.z == near(pressed.z, {.relative = 1e-12}));
}

namespace {

struct Outcome {
    std::vector<std::array<int, 4>> nodes;
    double energy, step;
    std::vector<double> numbers;
    bool operator==(const Outcome&) const = default;
};

}  // namespace

TEST_CASE("the same bits on any number of threads") {
    const SpringBody body = two_boxes(8);
    const Contact contact = contact_of(body, usual);
    const Vector x = approached(contact, 729, 1.6e-3, 3e-5, 5);
    Vector dx = Vector::Zero(x.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) dx[i] = i < 3 * 729 ? 0 : -1e-3 * (1 + std::sin(double(i)));
    const auto outcome = [&](std::size_t threads) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        const Pairs pairs = contact.find(span(x));
        Outcome o{{}, contact.energy(pairs, span(x)), contact.largest_step(span(x), span(dx)), {}};
        for (const Pair& pair : pairs) o.nodes.push_back(pair.nodes);
        o.numbers.resize(static_cast<std::size_t>(x.size()));
        contact.add_gradient(pairs, span(x), o.numbers);
        contact.visit_hessian(pairs, span(x), true, [&](int, int, const linalg::Matrix3& b) {
            o.numbers.insert(o.numbers.end(), b.data(), b.data() + 9);
        });
        return o;
    };
    const Outcome one = outcome(1);
    CHECK(one.nodes.size() > 300);
    CHECK(one.step < 1);
    for (const std::size_t threads : {2u, 4u, 7u})
        for (int repeat = 0; repeat < 3; ++repeat) CHECK(outcome(threads) == one);
}

TEST_CASE("bodies that touch at rest are bonded: no contact force, no limited step") {
    SpringBody body = spring_box({0, 0, 0}, {0.01, 0.01, 0.01}, {2, 2, 2});
    body.add(spring_box({0, 0, 0.01}, {0.01, 0.01, 0.01}, {3, 3, 3}));
    const Contact contact = contact_of(body, usual);
    CHECK(contact.find(contact.rest()).empty());
    const std::vector<double> still(contact.rest().size(), 0.0);
    CHECK(contact.largest_step(contact.rest(), still) == 1);
}

TEST_CASE("invalid settings and obstacles are refused by name") {
    const SpringBody body = spring_box({0, 0, 0}, {0.01, 0.01, 0.01}, {1, 1, 1});
    const Surface surface = make_surface(body.triangles);
    const auto message = [&](const Settings& settings, std::vector<Obstacle> obstacles) -> std::string {
        const auto contact = Contact::create(surface, std::move(obstacles), settings, body.rest);
        return contact ? "accepted" : contact.error().message;
    };
    CHECK(message(usual, {}) == "accepted");
    Settings bad = usual;
    bad.distance_m = 0;
    CHECK(message(bad, {}).find("distance") != std::string::npos);
    bad = usual;
    bad.stiffness_Pa = NAN;
    CHECK(message(bad, {}).find("stiffness") != std::string::npos);
    bad = usual;
    bad.slip_m = -1;
    CHECK(message(bad, {}).find("slip") != std::string::npos);
    const auto refused = [&](const Obstacle& obstacle) {
        const std::string text = message(usual, {obstacle});
        CAPTURE(text);
        CHECK(text.starts_with("obstacle \"it\""));
    };
    refused({"it", HalfSpace{{0, 0, 0}, {0, 0, 0}}});
    CHECK(message(usual, {{"it", HalfSpace{{0, 0, 0}, {0, 0, 1}}}}) == "accepted");  // it stands there
    refused({"it", HalfSpace{{0, 0, 1e-6}, {0, 0, 1}}});
    refused({"it", HalfSpace{{0, 0, 0.005}, {0, 0, 1}}});
    refused({"it", HalfSpace{{0, 0, -1}, {0, 0, 1}}, -0.5});
    refused({"it", mesh::TriMesh{}});
    refused({"it", mesh::TriMesh{{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}, {{0, 1, 3}}}});
    refused({"it", mesh::TriMesh{{{0.005, -1, 0.02}, {0.005, 1, 0.02}, {0.005, 0, -1}}, {{0, 1, 2}}}});
    refused({"it", mesh::TriMesh{{{-1, -1, 0.01}, {1, -1, 0.01}, {0, 1, 0.01}}, {{0, 1, 2}}}});
}

TEST_CASE("obstacles must leave a gap where they are at the start of the program, too, and errors name the lines") {
    const SpringBody body = spring_box({0, 0, 0}, {0.01, 0.01, 0.01}, {2, 2, 2});
    const auto error = [&](Obstacle obstacle, const Vec3& start_m) {
        obstacle.start_m = start_m;
        obstacle.line = 7, obstacle.start_line = 9;
        const auto contact = Contact::create(make_surface(body.triangles), {std::move(obstacle)}, usual, body.rest);
        return contact ? Error{Cause::input, "accepted"} : contact.error();
    };
    const auto check = [&](const Obstacle& obstacle, const Vec3& start_m, int line, const std::string& words) {
        const Error found = error(obstacle, start_m);
        CHECK_MESSAGE(found.message.find(words) != std::string::npos, found.message);
        CHECK((found.problems.empty() ? 0 : found.problems[0].line) == line);
    };
    const auto box = [](const Vec3& corner, double size) {
        const SpringBody drawn = spring_box(corner, {size, size, size}, {1, 1, 1});
        mesh::TriMesh surface;
        for (std::size_t i = 0; i < drawn.node_count(); ++i)
            surface.points.push_back(node_at(drawn.rest, static_cast<int>(i)));
        surface.triangles = drawn.triangles;
        return surface;
    };
    const std::string start = "the robot at the start, where the key at time 0 moves it: leave a gap";
    const Obstacle press{"it", HalfSpace{{0, 0, 0.0105}, {0, 0, -1}}};
    check(press, {}, 0, "accepted");
    check(press, {0, 0, -0.0004}, 0, "accepted");
    check(press, {0, 0, 1}, 0, "accepted");
    check(press, {0, 0, -0.0006}, 9, start);
    check(press, {0, 0, -1}, 9, start);
    const Obstacle block{"it", box({0.002, 0.002, 0.0105}, 0.004)};
    check(block, {0, 0, -0.0004}, 0, "accepted");
    check(block, {0, 0, -0.0006}, 9, start);
    check(block, {0, 0, -0.0075}, 9,
          "obstacle \"it\" begins inside the robot, which is solid, where the key at time 0");
    check(block, {0, 0, -0.02}, 0, "accepted");  // beyond it
    check({"it", HalfSpace{{0, 0, 0.005}, {0, 0, 1}}}, {}, 7, "at rest: leave a gap, or hold the robot there");
    check({"it", HalfSpace{{0, 0, -0.001}, {0, 0, -1}}}, {}, 7,
          "at rest: all of it lies behind the plane, where the obstacle is solid; turn the normal round, to [0, 0, 1], "
          "or move the point");
    check({"it", box({-1, -1, 0.005}, 2)}, {}, 7, "; its size is 200 times that of the robot: is it drawn in another");
}

TEST_CASE("solids that begin inside one another are refused, hollows are not") {
    const SpringBody body = spring_box({0, 0, 0}, {0.01, 0.01, 0.01}, {2, 2, 2});
    const auto box = [](double low, double high, bool inwards = false) {
        const SpringBody drawn = spring_box({low, low, low}, {high - low, high - low, high - low}, {1, 1, 1});
        mesh::TriMesh surface;
        for (std::size_t i = 0; i < drawn.node_count(); ++i)
            surface.points.push_back(node_at(drawn.rest, static_cast<int>(i)));
        surface.triangles = drawn.triangles;
        for (auto& t : surface.triangles)
            if (inwards) std::swap(t[0], t[1]);
        return surface;
    };
    const auto message = [&](mesh::TriMesh obstacle) -> std::string {
        const auto contact =
            Contact::create(make_surface(body.triangles), {{"it", std::move(obstacle)}}, usual, body.rest);
        return contact ? "accepted" : contact.error().message;
    };
    CHECK(message(box(0.004, 0.006)) ==
          "obstacle \"it\" begins inside the robot, which is solid: move it out, or cut a hollow for it");
    CHECK(message(box(-0.01, 0.02)) ==
          "the robot begins inside obstacle \"it\", which is solid: move it out, or cut a hollow for it");
    mesh::TriMesh hollow = box(-0.02, 0.03);
    const mesh::TriMesh inner = box(-0.01, 0.02, true);
    const int first = static_cast<int>(hollow.points.size());
    hollow.points.insert(hollow.points.end(), inner.points.begin(), inner.points.end());
    for (const auto& t : inner.triangles) hollow.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    CHECK(message(hollow) == "accepted");
    CHECK(message(box(0.02, 0.03)) == "accepted");
}

namespace {

/// A box in which every third point of the top has a duplicate next to it: fans of needles, some of whose edges are
/// within nanometres of others with which they share no node.
SpringBody box_with_slivers(double hair) {
    SpringBody body = spring_box({0, 0, 0}, {0.01, 0.01, 0.01}, {4, 4, 4}, 0.1);
    const std::vector<std::array<int, 3>> whole = body.triangles;
    body.triangles.clear();
    int count = 0;
    for (const auto& t : whole) {
        if (count++ % 3 != 0) {
            body.triangles.push_back(t);
            continue;
        }
        // A point just inside one side: two slender triangles and a needle along that side.
        const Vec3 a = node_at(body.rest, t[0]), b = node_at(body.rest, t[1]), c = node_at(body.rest, t[2]);
        const Vec3 m = 0.5 * (a + b), p = m + hair / norm(c - m) * (c - m);
        const int node = static_cast<int>(body.node_count());
        body.rest.insert(body.rest.end(), {p.x, p.y, p.z});
        for (const int corner : t) body.springs.push_back({node, corner, norm(p - node_at(body.rest, corner))});
        body.triangles.insert(body.triangles.end(), {{t[0], t[1], node}, {t[1], t[2], node}, {t[2], t[0], node}});
    }
    return body;
}

}  // namespace

TEST_CASE("surfaces of slivers, close together at rest, do not limit the step") {
    for (const double hair : {3e-10, 6e-8, 1e-6}) {
        CAPTURE(hair);
        const SpringBody body = box_with_slivers(hair);
        const Contact contact = contact_of(body, usual);
        // Shear that closes half of the hairs, and then some.
        Vector dx = Vector::Zero(static_cast<Eigen::Index>(body.rest.size()));
        for (Eigen::Index i = 0; i < dx.size() / 3; ++i) {
            const Vec3 p = node_at(body.rest, static_cast<int>(i));
            dx.segment<3>(3 * i) << 0.2 * p.z + 0.1 * p.y, -0.15 * p.x, 0.1 * p.y;
            if (i >= 125) dx.segment<3>(3 * i) += Eigen::Vector3d(3, -2, 1) * hair;
        }
        CHECK(contact.largest_step(contact.rest(), span(dx)) == 1);
        const Vector x = vector_of(contact.rest()) + dx;
        CHECK(contact.find(span(x)).empty());
        CHECK_FALSE(contact.crossing(span(x)).has_value());
    }
}

TEST_CASE("a crossing is reported with its place, with or without self-contact") {
    const SpringBody body = two_boxes(3);
    Settings without_self = usual;
    without_self.self = false;
    for (const Settings& settings : {usual, without_self}) {
        const Contact contact = contact_of(body, settings);
        CHECK_FALSE(contact.crossing(contact.rest()).has_value());
        CHECK_FALSE(contact.crossing(span(approached(contact, 64, 1.9e-3, 0, 1))).has_value());
        const auto crossing = contact.crossing(span(approached(contact, 64, 2.3e-3, 0, 1)));
        REQUIRE(crossing);
        // The upper box's sides pass through the lower one's top, or its bottom is passed through by the lower's edges.
        CHECK(crossing->point_m.z > 0.0096);
        CHECK(crossing->point_m.z < 0.0101);
        CHECK(crossing->obstacle == -1);
    }
    // Intersections at rest are reported once, and ignored afterwards.
    SpringBody overlapping = spring_box({0, 0, 0}, {0.01, 0.01, 0.01}, {2, 2, 2});
    overlapping.add(spring_box({0.0013, 0.0021, 0.009}, {0.008, 0.0085, 0.01}, {2, 2, 2}));
    const Contact contact = contact_of(overlapping, usual);
    CHECK(contact.crossing_at_rest().has_value());
    CHECK_FALSE(contact.crossing(contact.rest()).has_value());
}

TEST_CASE("an obstacle acts where it is drawn: the robot rests within a tenth of the contact distance") {
    // A cube on a floor and on a block, under a pressure of 3 % of the stiffness: without insets it would hover at 0.97
    // of the distance above.
    const SpringBody body = spring_box({0, 0, 0.003}, {0.01, 0.01, 0.01}, {2, 2, 2});
    mesh::TriMesh block;
    for (int k = 0; k < 8; ++k)
        block.points.push_back({k & 1 ? 0.05 : -0.03, k & 2 ? 0.04 : -0.03, k & 4 ? 0.0 : -0.02});
    block.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                       {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    for (const Obstacle& obstacle : {Obstacle{"floor", HalfSpace{{}, {0, 0, 1}}}, Obstacle{"block", block}}) {
        CAPTURE(obstacle.name);
        const Contact contact = contact_of(body, usual, {obstacle});
        const std::size_t n = body.node_count();
        Statics statics{&body,
                        500,
                        &contact,
                        std::vector<double>(3 * n),
                        std::vector<double>(n, 1e-3),
                        body.rest,
                        std::vector<bool>(static_cast<std::size_t>(contact.node_count()))};
        for (std::size_t i = 0; i < n; ++i) statics.load[3 * i + 2] = -0.03 / static_cast<double>(n);
        for (std::size_t i = n; i < statics.held.size(); ++i) statics.held[i] = true;
        Vector x = vector_of(contact.rest());
        REQUIRE(statics.minimise(x, nullptr, 1e-8) > 0);
        const double lowest = [&] {
            double z = 1;
            for (std::size_t i = 0; i < n; ++i) z = std::min(z, x[static_cast<Eigen::Index>(3 * i + 2)]);
            return z;
        }();
        CHECK(std::abs(lowest) < 0.1 * usual.distance_m);
        const double apart = contact.smallest_distance(contact.find(span(x)), span(x));
        CHECK(apart == near(lowest, {.relative = 1e-9}));
    }
}

TEST_CASE("what touches what: every obstacle counts for itself") {
    const SpringBody body = spring_box({0.003, 0, 0.003}, {0.01, 0.01, 0.01}, {2, 2, 2});
    const Contact contact =
        contact_of(body, usual, {{"floor", HalfSpace{{}, {0, 0, 1}}}, {"wall", HalfSpace{{}, {1, 0, 0}}}});
    const auto partners_at = [&](double x_m, double z_m) {
        Vector x = vector_of(contact.rest());
        for (std::size_t i = 0; i < body.node_count(); ++i) {
            x[static_cast<Eigen::Index>(3 * i)] += x_m - 0.003;
            x[static_cast<Eigen::Index>(3 * i + 2)] += z_m - 0.003;
        }
        return contact.partners(contact.find(span(x)));
    };
    using Partners = std::vector<std::array<int, 2>>;
    const double close_m = 0.05 * usual.distance_m;  // obstacles are drawn in by most of the distance
    CHECK(partners_at(0.003, 0.003).empty());
    CHECK(partners_at(0.003, close_m) == Partners{{-1, 0}});
    CHECK(partners_at(close_m, 0.003) == Partners{{-2, 0}});
    CHECK(partners_at(close_m, close_m) == Partners{{-2, 0}, {-1, 0}});
}

namespace {

double from_sphere(const Vec3& center, double radius_m, const std::array<int, 3>& t, std::span<const double> x) {
    const Stencil at{center, node_at(x, t[0]), node_at(x, t[1]), node_at(x, t[2])};
    return std::sqrt(squared_distance(nearest_point_triangle(at), at)) - radius_m;
}

}  // namespace

TEST_CASE("a sphere meets the triangles near it, and no step lets it into the robot") {
    const SpringBody body = spring_box({-0.005, -0.005, -0.01}, {0.01, 0.01, 0.01}, {4, 4, 4}, 0.1);
    const Sphere ball{{0.001, -0.0005, 0.0062}, 0.006};
    Settings settings = usual;
    settings.self = false;
    const Contact contact = contact_of(body, settings, {{"ball", ball, 0.3}});
    const int centre = contact.first_node(0);
    CHECK(contact.node_count() == contact.robot_node_count() + 1);
    const double acts_m = ball.radius_m - 0.9 * usual.distance_m;
    std::mt19937 random(3);
    int hindered = 0;
    std::size_t met = 0;
    for (int k = 0; k < 40; ++k) {
        Vector x = vector_of(contact.rest());
        x[3 * centre + 2] -= 5e-4;
        Vector dx(x.size());
        for (Eigen::Index i = 0; i < x.size() / 3; ++i) {
            const Vec3 v = 0.002 * random_vector(random) + (i == centre ? Vec3{0, 0, -1e-3 * (k % 4)} : Vec3{});
            dx.segment<3>(3 * i) << v.x, v.y, v.z;
        }
        const double step = contact.largest_step(span(x), span(dx));
        CHECK(step > 0);
        for (int s = 0; s <= 5; ++s) {
            const Vector there = x + s * step / 5 * dx;
            std::size_t near = 0;
            for (const auto& t : body.triangles) {
                const double apart = from_sphere(node_at(span(there), centre), acts_m, t, span(there));
                const double at_rest = from_sphere(ball.center, acts_m, t, body.rest);
                REQUIRE(apart > 0);
                near += apart < std::min(usual.distance_m, at_rest) ? 1 : 0;
            }
            met += near;
            CHECK(contact.find(span(there)).size() == near);
            CHECK(std::isfinite(contact.energy(contact.find(span(there)), span(there))));
        }
        if (step == 1) continue;
        ++hindered;
        CHECK_FALSE(contact.is_free(span(x), span(dx)));
        CHECK(contact.meets(span(x), span(dx)));
    }
    CHECK(hindered > 10);
    CHECK(met > 100);
}

TEST_CASE("a sphere that slides over the robot pulls it along") {
    const SpringBody body = spring_box({-0.005, -0.005, -0.01}, {0.01, 0.01, 0.01}, {4, 4, 4});
    const Contact contact = contact_of(body, usual, {{"ball", Sphere{{0, 0, 0.0065}, 0.006}, 0.5}});
    const int centre = contact.first_node(0);
    Vector x = vector_of(contact.rest());
    x[3 * centre + 2] -= 1e-3;
    const Vector start = x;
    x[3 * centre] += 1e-3;
    const Pairs pairs = contact.find(span(x));
    REQUIRE_FALSE(pairs.empty());
    const Friction friction = contact.freeze(pairs, span(x), span(start));
    const Forces pressed = contact.forces(pairs, span(x), nullptr), all = contact.forces(pairs, span(x), &friction);
    CHECK(pressed.on_robot_N[0].z < 0);
    CHECK(all.on_robot_N[0].x - pressed.on_robot_N[0].x > 0.4 * std::fabs(pressed.on_robot_N[0].z));
    CHECK(pressed.smallest_distance_m < 0.5 * usual.distance_m);
}

TEST_CASE("a flat face of an object, however it is divided, meets a sphere once") {
    const SpringBody object = spring_box({-0.005, -0.005, -0.01}, {0.01, 0.01, 0.01}, {4, 4, 4});
    const int nodes = static_cast<int>(object.node_count());
    const auto contact =
        Contact::create(make_surface(object.triangles), {{"ball", Sphere{{0.0001, 0.0002, 0.0065}, 0.006}, 0}}, usual,
                        object.rest, {{"cube", 0, nodes}});
    REQUIRE_MESSAGE(contact.has_value(), contact.error().message);
    Vector x = vector_of(contact->rest());
    x[3 * contact->first_node(0) + 2] -= 1e-3;
    const Pairs pairs = contact->find(span(x));
    REQUIRE(pairs.size() == 1);
    CHECK(pairs[0].kind == PairKind::sphere_triangle);
    CHECK(contact->find_near(span(x), 2e-3).size() == 1);
    CHECK(contact->forces(pairs, span(x), nullptr).on_rigid_N[0].z < 0);
}

TEST_CASE("a sphere that touches, holds or begins inside the robot is refused") {
    const SpringBody body = spring_box({-0.005, -0.005, -0.01}, {0.01, 0.01, 0.01}, {4, 4, 4});
    const auto refusal = [&](const Sphere& sphere) {
        const auto contact = Contact::create(make_surface(body.triangles), {{"ball", sphere, 0}}, usual, body.rest);
        return contact ? std::string() : contact.error().message;
    };
    CHECK(refusal({{0, 0, 0.0061}, 0.006}).empty());
    CHECK(refusal({{0, 0, 0.006}, 0.006}).starts_with("obstacle \"ball\" touches or crosses the robot at rest"));
    CHECK(refusal({{0, 0, 0.005}, 0.006}).starts_with("obstacle \"ball\" touches or crosses the robot at rest"));
    CHECK(refusal({{0, 0, -0.005}, 0.05}).ends_with("all of it lies inside the obstacle, which is solid: move it out"));
    CHECK(refusal({{0, 0, -0.005}, 0.002}).starts_with("obstacle \"ball\" begins inside the robot, which is solid"));
    CHECK(refusal({{0, 0, 1}, 0}).ends_with("a sphere needs a centre, and a radius above zero"));
}
