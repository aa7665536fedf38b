// Speed of the contact kernels on 12,096 triangles: two boxes that face each other, a little crumpled, with few or many
// pairs in touch. `pairs` says how many.
#include <benchmark/benchmark.h>

#include <cmath>

#include "simulation/contact/contact.hpp"
#include "simulation/peers/reference_problems.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::contact;

namespace {

struct Scene {
    Contact contact;
    std::vector<double> x, dx;
};

void add_box(mesh::TetMesh& mesh, double z) {
    const mesh::TetMesh box = reference::kuhn_box({0.042, 0.021, 0.01}, 42, 21, 10, [](Vec3) { return 0; });
    const int first = static_cast<int>(mesh.points.size());
    for (const Vec3& p : box.points) mesh.points.push_back(p + Vec3{0, 0, z});
    for (const int n : box.nodes) mesh.nodes.push_back(n + first);
    mesh.region.resize(mesh.tet_count(), 0);
    mesh.region_names = {"all"};
}

/// Elements of 1 mm, a gap of 2 mm at rest, contact below 0.5 mm. The upper box comes down until `gap_m` is left,
/// bulged so that it is least in the middle, and would go on by 0.4 mm.
Scene facing_boxes(double gap_m, double bulge_m) {
    mesh::TetMesh mesh;
    add_box(mesh, 0);
    const std::size_t lower = mesh.points.size();
    add_box(mesh, 0.012);
    std::vector<double> rest;
    for (const Vec3& p : mesh.points) rest.insert(rest.end(), {p.x, p.y, p.z});
    auto contact = Contact::create(robot_surface(mesh), {}, {.distance_m = 5e-4, .stiffness_Pa = 1e5}, rest);
    Scene scene{*contact, rest, std::vector<double>(rest.size())};
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        const Vec3& p = mesh.points[i];
        const double away = std::hypot(p.x - 0.021, p.y - 0.0105) / 0.02;
        for (std::size_t c = 0; c < 3; ++c)
            scene.x[3 * i + c] += 2e-5 * std::sin(1e5 * p.x + 7e4 * p.y + 3e4 * p.z + c);
        if (i < lower) continue;
        scene.x[3 * i + 2] += gap_m - 0.002 + bulge_m * away * away;
        scene.dx[3 * i + 2] = -4e-4;
    }
    return scene;
}

Scene scene_of(bool many) {
    return many ? facing_boxes(3e-4, 0) : facing_boxes(4.5e-4, 5e-3);
}

void contact_find(benchmark::State& state, bool many) {
    const Scene s = scene_of(many);
    Pairs pairs;
    for (auto _ : state) benchmark::DoNotOptimize(pairs = s.contact.find(s.x));
    state.counters["pairs"] = static_cast<double>(pairs.size());
}

void contact_largest_step(benchmark::State& state, bool many) {
    const Scene s = scene_of(many);
    double step = 0;
    for (auto _ : state) benchmark::DoNotOptimize(step = s.contact.largest_step(s.x, s.dx));
    state.counters["step"] = step;
}

void contact_hessian(benchmark::State& state, bool project) {
    const Scene s = scene_of(true);
    const Pairs pairs = s.contact.find(s.x);
    double sum = 0;
    for (auto _ : state)
        s.contact.visit_hessian(pairs, s.x, project, [&](int, int, const linalg::Matrix3& b) { sum += b(0, 0); });
    benchmark::DoNotOptimize(sum);
    state.counters["pairs"] = static_cast<double>(pairs.size());
}

void contact_create(benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(scene_of(true).x.data());
}

}  // namespace

BENCHMARK_CAPTURE(contact_find, few_pairs, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(contact_find, many_pairs, true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(contact_largest_step, few_pairs, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(contact_largest_step, many_pairs, true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(contact_hessian, exact, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(contact_hessian, projected, true)->Unit(benchmark::kMillisecond);
BENCHMARK(contact_create)->Unit(benchmark::kMillisecond);
