// Where surfaces cut through each other or touch.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/core/boxes.hpp"
#include "simulation/contact/contact_search.hpp"
#include "simulation/contact/intersection.hpp"

namespace pliant::sim::contact {

std::optional<Crossing> Contact::first_crossing(std::span<const double> x, bool self, bool at_rest) const {
    using Found = std::optional<Crossing>;
    const Search search(*this, x, {}, 0, Search::What::crossings, self);
    const auto test = [&](const Search::Candidate& c, Found& found) {
        const auto& n = c.nodes;
        const bool joined =
            std::find(n.begin() + 2, n.end(), n[0]) != n.end() || std::find(n.begin() + 2, n.end(), n[1]) != n.end();
        if (found || joined) return;
        const Vec3 a = node_at(x, n[0]), b = node_at(x, n[1]);
        const Vec3 t0 = node_at(x, n[2]), t1 = node_at(x, n[3]), t2 = node_at(x, n[4]);
        const Rim rim = at_rest ? Rim::left_out : Rim::counts;
        if (!segment_crosses_triangle(a, b, t0, t1, t2, rim) || (!at_rest && edge_and_triangle_belong_together(n)) ||
            are_joined(std::span(n).first(2), std::span(n).last(3)))
            return;
        const int obstacle = std::max(obstacle_of_node_[n[0]], obstacle_of_node_[n[2]]);
        found = {{n[0], n[1]}, {n[2], n[3], n[4]}, obstacle, point_in_plane(a, b, t0, t1, t2)};
    };
    for (const Found& piece : search.run(Found{}, test))
        if (piece) return piece;
    return {};
}

bool Contact::edge_and_triangle_belong_together(std::span<const int, 5> n) const {
    const std::span<const int> edge = n.first<2>(), triangle = n.last<3>();
    const auto r = [&](std::size_t k) { return node_at(rest_, n[k]); };
    if (segment_crosses_triangle(r(0), r(1), r(2), r(3), r(4))) return true;
    double squared = std::numeric_limits<double>::infinity();
    const auto offer = [&](Features features, const Stencil& at) {
        squared = std::min(squared, squared_distance(nearest(features, at), at));
    };
    for (std::size_t k = 0; k < 2; ++k) offer(Features::point_triangle, {r(k), r(2), r(3), r(4)});
    for (std::size_t k = 0; k < 3; ++k) offer(Features::edge_edge, {r(0), r(1), r(2 + k), r(2 + (k + 1) % 3)});
    return left_out(edge, triangle, std::sqrt(squared));
}

std::optional<Crossing> Contact::crossing(std::span<const double> x) const {
    return first_crossing(x, true, false);
}

std::optional<Crossing> Contact::crossing_at_rest() const {
    const auto found = first_crossing(rest_, true, true);
    return found && found->obstacle < 0 ? found : std::nullopt;
}

std::optional<Contact::Touched> Contact::obstacle_touched(std::span<const double> x) const {
    std::optional<Touched> touched = touched_by_exact(x);
    const Search search(*this, x, {}, touching_m_, Search::What::pairs, false);
    const auto moving = [&](int a, int b) { return part_of(obstacle_of_node_[a] < 0 ? a : b); };
    const auto test = [&](const Search::Candidate& c, std::optional<Touched>& found) {
        const int obstacle = obstacle_of(c.nodes);
        if (obstacle >= 0 && std::sqrt(c.squared_distance(x)) <= touching_m_)
            found = {obstacle, moving(c.nodes[0], c.nodes[3])};
    };
    for (const auto& piece : search.run(std::optional<Touched>(), test)) touched = piece ? piece : touched;
    const auto crossed = first_crossing(x, false, true);
    if (crossed && crossed->obstacle >= 0)
        touched = {crossed->obstacle, moving(crossed->edge[0], crossed->triangle[0])};
    return touched;
}

std::string Contact::advice_on(const Touched& touched) const {
    constexpr double other_unit = 100;  // sizes that differ by more are rarely meant
    const std::vector<int>& points =
        side(touched.part == 0 ? 0 : static_cast<std::size_t>(touched.part) + 1).surface.points;
    for (const Plane& plane : planes_) {
        const auto is_behind = [&](int point) {
            return dot(plane.normal, node_at(rest_, point) - node_at(rest_, plane.node)) <= touching_m_;
        };
        if (plane.obstacle == touched.obstacle && std::ranges::all_of(points, is_behind))
            return fmt::format(
                "all of it lies behind the plane, where the obstacle is solid; turn the normal round, to [{:.6g}, "
                "{:.6g}, {:.6g}], or move the point",
                0 - plane.normal.x, 0 - plane.normal.y, 0 - plane.normal.z);
    }
    for (const Ball& ball : balls_) {
        const auto is_inside = [&](int point) {
            return norm(node_at(rest_, point) - node_at(rest_, ball.node)) <= ball.radius_m;
        };
        if (ball.obstacle == touched.obstacle && std::ranges::all_of(points, is_inside))
            return "all of it lies inside the obstacle, which is solid: move it out";
    }
    Box3 part, obstacle;
    for (const int point : points) part.add(node_at(rest_, point));
    const auto k = static_cast<std::size_t>(touched.obstacle);
    for (int node = first_node_[k]; node < first_node_[k + 1]; ++node) obstacle.add(node_at(rest_, node));
    if (const auto* sphere = std::get_if<Sphere>(&obstacles_[k].shape)) {
        const Vec3 corner{sphere->radius_m, sphere->radius_m, sphere->radius_m};
        obstacle.add(sphere->center - corner);
        obstacle.add(sphere->center + corner);
    }
    const double times = obstacle.diagonal() / part.diagonal();
    const bool is_plane = std::holds_alternative<HalfSpace>(obstacles_[k].shape);
    return fmt::format("leave a gap{}{}", touched.part == 0 ? ", or hold the robot there" : "",
                       is_plane || (times < other_unit && times > 1 / other_unit)
                           ? ""
                           : fmt::format("; its size is {:.3g} times that of {}: is it drawn in another unit?", times,
                                         part_name(touched.part)));
}

Status Contact::check_obstacles(std::span<const double> x, When when) const {
    const auto touched = obstacle_touched(x);
    if (!touched) return {};
    const Obstacle& obstacle = obstacles_[static_cast<std::size_t>(touched->obstacle)];
    if (when == When::start)
        return input_error_at("", obstacle.start_line,
                              "obstacle \"{}\" touches or crosses {} at the start, where the key at time 0 moves it: "
                              "leave a gap there",
                              obstacle.name, part_name(touched->part));
    return input_error_at("", obstacle.line, "obstacle \"{}\" touches or crosses {} at rest: {}", obstacle.name,
                          part_name(touched->part), advice_on(*touched));
}

std::string Contact::part_name(int part) const {
    return part == 0 ? "the robot" : "object \"" + rigid_[static_cast<std::size_t>(part) - 1].name + "\"";
}

Status Contact::check_parts_at_rest() const {
    const auto refused = [&](int a, int b) {
        const auto [low, high] = std::minmax({part_of(a), part_of(b)});
        return input_error_at("", rigid_[static_cast<std::size_t>(high) - 1].line,
                              "{} touches or crosses {} at rest: leave a gap", part_name(high), part_name(low));
    };
    using Found = std::optional<std::array<int, 2>>;
    const Search search(*this, rest_, {}, touching_m_, Search::What::pairs, false);
    const auto test = [&](const Search::Candidate& c, Found& found) {
        if (part_of(c.nodes[0]) != part_of(c.nodes[3]) && obstacle_of(c.nodes) < 0 &&
            std::sqrt(c.squared_distance(rest_)) <= touching_m_ && !are_joined(c.first_nodes(), c.second_nodes()))
            found = {c.nodes[0], c.nodes[3]};
    };
    for (const Found& piece : search.run(Found{}, test))
        if (piece) return refused((*piece)[0], (*piece)[1]);
    const auto crossed = first_crossing(rest_, false, true);
    if (crossed && crossed->obstacle < 0 && part_of(crossed->edge[0]) != part_of(crossed->triangle[0]))
        return refused(crossed->edge[0], crossed->triangle[0]);
    return {};
}

}  // namespace pliant::sim::contact
