#include "geometry/threemf/build.hpp"

#include <algorithm>

#include "geometry/threemf/bodies.hpp"

namespace pliant::threemf {
namespace {

constexpr int max_depth = 64;
constexpr std::size_t max_visits = 1000000, max_triangles = 100000000;

Contour transformed(const Contour& contour, const Transform& transform, double mm_per_unit) {
    Contour result;
    for (const auto& [x, y] : contour) {
        const Vec3 p = transform(Vec3{x, y, 0} * mm_per_unit);
        result.push_back({p.x, p.y});
    }
    if (transform.determinant() * transform.m[8] < 0) std::reverse(result.begin(), result.end());
    return result;
}

Transform in_mm(Transform transform, double mm_per_unit) {
    for (std::size_t i = 9; i < 12; ++i) transform.m[i] *= mm_per_unit;
    return transform;
}

}  // namespace

Result<ThreeMf> Build::assemble(ModelPart start) {
    const std::vector<Placed> items = start.items;
    built_.warnings = start.warnings;
    parts_.emplace("", std::move(start));
    for (const Placed& item : items) {
        if (!item.printable) {
            built_.warnings.push_back(fmt::format(
                "{}object {} is excluded from printing (printable=\"0\") and left out", item.where, item.object));
            continue;
        }
        ++built_.items;
        if (auto status = place("", item, Transform{}, 0); !status) return tl::unexpected(status.error());
    }
    const auto is_printable = [](const Placed& item) { return item.printable; };
    if (!items.empty() && std::none_of(items.begin(), items.end(), is_printable))
        return input_error("{}: every item of its build is excluded from printing (printable=\"0\")", file_);
    if (built_.bodies.empty()) return input_error("{}: its build holds no body", file_);
    std::sort(built_.warnings.begin(), built_.warnings.end());
    built_.warnings.erase(std::unique(built_.warnings.begin(), built_.warnings.end()), built_.warnings.end());
    return std::move(built_);
}

Result<const ModelPart*> Build::part(const std::string& path) {
    const auto known = parts_.find(path);
    if (known != parts_.end()) return &known->second;
    if (package_ == nullptr) return input_error("{}: names the part {}, there are no others", file_, path);
    const auto text = package_->part(path);
    if (!text) return tl::unexpected(text.error());
    auto read = read_model_part(*text);
    if (!read) return tl::unexpected(read.error());
    return &parts_.emplace(path, std::move(*read)).first->second;
}

Status Build::place(const std::string& path, const Placed& placed, const Transform& transform, int depth) {
    if (depth > max_depth || ++visits_ > max_visits)
        return input_error("{}objects nested deeper than {} or placed more than {} times", placed.where, max_depth,
                           max_visits);
    const std::string& where = placed.path.empty() ? path : placed.path;
    const auto holder = part(path);
    const auto part = this->part(where);
    if (!part) return tl::unexpected(part.error());
    const auto found = (*part)->objects.find(placed.object);
    if (found == (*part)->objects.end())
        return input_error("{}objectid: {} has no object {}", placed.where, where, placed.object);
    const Object& object = found->second;
    if (object.type == "other" && depth == 0)
        return input_error("{}object {} is of type \"other\", which is not to be built", placed.where, placed.object);
    const Transform own = in_mm(placed.transform, (*holder)->mm_per_unit).then(transform);
    if (object.components.empty()) return add_mesh(**part, object, own);
    for (const Placed& component : object.components) {
        if (auto status = place(where, component, own, depth + 1); !status) return status;
    }
    return {};
}

Status Build::add_mesh(const ModelPart& part, const Object& object, const Transform& transform) {
    triangles_ += object.mesh.triangles.size();
    if (triangles_ > max_triangles) return input_error("{}: more than {} triangles", file_, max_triangles);
    std::vector<std::string> warnings;
    std::vector<Body> bodies = split_by_material(object, warnings);
    for (const std::string& w : warnings) built_.warnings.push_back(fmt::format("{}: {}", file_, w));
    const bool mirrored = transform.determinant() < 0;
    for (Body& body : bodies) {
        for (Vec3& p : body.mesh_mm.points) p = transform(p * part.mm_per_unit);
        if (mirrored) {
            for (auto& t : body.mesh_mm.triangles) std::swap(t[1], t[2]);
        }
    }
    if (object.slice_stack >= 0) {
        bodies.resize(1);
        const auto path = std::find_if(parts_.begin(), parts_.end(), [&](const auto& p) { return &p.second == &part; });
        if (auto status = add_slices(path->first, object, transform, bodies[0]); !status) return status;
    }
    for (Body& body : bodies) {
        if (body.mesh_mm.triangles.empty() && body.slices.empty())
            return input_error("{}: {}: has neither triangles nor slices", file_, object.name);
        built_.bodies.push_back(std::move(body));
    }
    return {};
}

Status Build::add_slices(const std::string& path, const Object& object, const Transform& transform, Body& body) {
    const auto& m = transform.m;
    if (m[2] != 0 || m[5] != 0 || m[6] != 0 || m[7] != 0 || m[8] <= 0)
        return input_error("{}: {}: an object with slices can only be turned about z, moved and scaled", file_,
                           object.name);
    auto read = slices(path, object.slice_stack, 0);
    if (!read) return tl::unexpected(read.error());
    for (Slice& slice : *read) {
        slice.bottom_mm = slice.bottom_mm * m[8] + m[11];
        slice.top_mm = slice.top_mm * m[8] + m[11];
        for (Contour& contour : slice.contours) contour = transformed(contour, transform, 1);
    }
    body.slices = std::move(*read);
    return {};
}

/// In millimetres, in the object's own coordinates.
Result<std::vector<Slice>> Build::slices(const std::string& path, int stack, int depth) {
    const auto part = this->part(path);
    if (!part) return tl::unexpected(part.error());
    const auto found = (*part)->stacks.find(stack);
    if (found == (*part)->stacks.end() || depth > 1)
        return input_error("{}: {}: there is no slice stack {} that holds slices", file_, path, stack);
    std::vector<Slice> result = found->second.slices;
    for (Slice& slice : result) {
        slice.bottom_mm *= (*part)->mm_per_unit;
        slice.top_mm *= (*part)->mm_per_unit;
        for (Contour& contour : slice.contours) contour = transformed(contour, Transform{}, (*part)->mm_per_unit);
    }
    for (const SliceStack::Reference& reference : found->second.references) {
        auto more = slices(reference.path, reference.stack, depth + 1);
        if (!more) return more;
        if (!result.empty() && !more->empty() && more->front().bottom_mm < result.back().top_mm - 1e-9)
            return input_error("{}: slice stack {} of {} begins below the end of the one before", file_,
                               reference.stack, reference.path);
        result.insert(result.end(), std::make_move_iterator(more->begin()), std::make_move_iterator(more->end()));
    }
    return result;
}

}  // namespace pliant::threemf
