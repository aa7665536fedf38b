#include "geometry/threemf/slice_stack.hpp"

namespace pliant::threemf {
namespace {

Contour read_polygon(const XmlPart& part, const pugi::xml_node& polygon, const Contour& points, Problem& problem) {
    Contour contour;
    const auto add = [&](const pugi::xml_node& node, const char* key) {
        const int i = part.index(node, key, problem);
        if (problem.found()) return;
        if (i >= static_cast<int>(points.size()))
            return problem.note(
                part.at(node, fmt::format("{}: there is no vertex {}, only {}", key, i, points.size())));
        contour.push_back(points[static_cast<std::size_t>(i)]);
    };
    add(polygon, "startv");
    for (const pugi::xml_node& segment : part.children(polygon, Space::slice, "segment")) add(segment, "v2");
    if (problem.found()) return {};
    if (contour.size() > 1 && contour.front() == contour.back()) contour.pop_back();
    return contour;
}

Slice read_slice(const XmlPart& part, const pugi::xml_node& node, double bottom, Problem& problem, std::size_t& thin) {
    Slice slice{bottom, part.number(node, "ztop", problem), {}};
    if (!problem.found() && !(slice.top_mm > bottom))
        problem.note(part.at(node, fmt::format("ztop {} must be above {}", slice.top_mm, bottom)));
    Contour points;
    for (const pugi::xml_node& v : part.children(part.child(node, Space::slice, "vertices"), Space::slice, "vertex"))
        points.push_back({part.number(v, "x", problem), part.number(v, "y", problem)});
    for (const pugi::xml_node& polygon : part.children(node, Space::slice, "polygon"))
        slice.contours.push_back(read_polygon(part, polygon, points, problem));
    thin += std::erase_if(slice.contours, [](const Contour& contour) { return contour.size() < 3; });
    return slice;
}

}  // namespace

SliceStack read_slice_stack(const XmlPart& part, const pugi::xml_node& node, Problem& problem,
                            std::vector<std::string>& warnings) {
    SliceStack stack;
    std::size_t thin = 0;
    double bottom = node.attribute("zbottom") ? part.number(node, "zbottom", problem) : 0;
    for (const pugi::xml_node& child : part.children(node, Space::slice, "slice")) {
        stack.slices.push_back(read_slice(part, child, bottom, problem, thin));
        if (problem.found()) return stack;
        bottom = stack.slices.back().top_mm;
    }
    for (const pugi::xml_node& child : part.children(node, Space::slice, "sliceref"))
        stack.references.push_back(
            {std::string(part.needed(child, "slicepath", problem)), part.index(child, "slicestackid", problem)});
    if (thin > 0)
        warnings.push_back(part.at(
            node, fmt::format("{} polygon(s) of fewer than three points enclose nothing and were left out", thin)));
    return stack;
}

}  // namespace pliant::threemf
