#include "printing/slice/braces.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace pliant::slice {
namespace {

double apart(const Pillar& a, const Pillar& b) {
    return std::hypot(a.x_um - b.x_um, a.y_um - b.y_um);
}

/// Struts between two pillars, from the lower end of their common height upwards; they start alternately from each
/// pillar.
std::vector<Strut> between(const Pillar& a, const Pillar& b, double radius_um) {
    const double low = std::max(a.low_um, b.low_um), high = std::min(a.high_um, b.high_um);
    const double rise = apart(a, b), step = std::max(slender * (a.radius_um + b.radius_um), rise);
    std::vector<Strut> struts;
    bool from_a = true;
    for (double z = low; z + rise <= high; z += step, from_a = !from_a) {
        const Pillar &from = from_a ? a : b, &to = from_a ? b : a;
        struts.push_back({{from.x_um, from.y_um, z}, {to.x_um, to.y_um, z + rise}, radius_um});
    }
    return struts;
}

/// Pillars that a strut may lead to, the nearest first. Pillars on the same axis count as one.
std::vector<std::size_t> neighbours(const std::vector<Pillar>& pillars, std::size_t i) {
    const double reach_um = 2 * slender * pillars[i].radius_um;
    std::vector<std::pair<double, std::size_t>> found;
    for (std::size_t j = 0; j < pillars.size(); ++j) {
        if (std::fabs(pillars[j].x_um - pillars[i].x_um) > reach_um) continue;
        const double way = apart(pillars[i], pillars[j]);
        if (j != i && way <= reach_um && way > pillars[i].radius_um + pillars[j].radius_um) found.emplace_back(way, j);
    }
    std::sort(found.begin(), found.end());
    std::vector<std::size_t> order;
    order.reserve(found.size());
    for (const auto& [way, j] : found) order.push_back(j);
    return order;
}

}  // namespace

Braces braces(const std::vector<Pillar>& pillars, double least_radius_um,
              const std::function<bool(const Strut&)>& barred) {
    constexpr int wanted = 2;  // held in two directions, a pillar cannot bend
    Braces made{{}, std::vector<bool>(pillars.size(), false)};
    std::set<std::pair<std::size_t, std::size_t>> tied;
    std::vector<int> ties(pillars.size(), 0);
    for (std::size_t i = 0; i < pillars.size(); ++i) {
        if (pillars[i].slenderness() <= slender) {
            made.held[i] = true;
            continue;
        }
        for (const std::size_t j : neighbours(pillars, i)) {
            if (ties[i] >= wanted) break;
            if (tied.contains(std::minmax(i, j))) continue;
            const double radius = std::max(least_radius_um, std::min(pillars[i].radius_um, pillars[j].radius_um) / 2);
            std::vector<Strut> struts = between(pillars[i], pillars[j], radius);
            std::erase_if(struts, barred);
            if (struts.empty()) continue;
            tied.insert(std::minmax(i, j));
            made.struts.insert(made.struts.end(), struts.begin(), struts.end());
            for (const std::size_t end : {i, j}) {
                ++ties[end];
                made.held[end] = true;
            }
        }
    }
    return made;
}

}  // namespace pliant::slice
