// The only file that includes gmshc.h: for the types of its functions, none of which is linked.
#include "mesh/gmsh_library.hpp"

#include <dlfcn.h>
#include <gmshc.h>

namespace pliant::mesh::gmsh {
namespace {

std::string last_loader_error() {
    const char* text = dlerror();
    return text != nullptr ? text : "no reason was given";
}

/// Stays loaded: Gmsh keeps state for the whole program, and unloading Open CASCADE is not safe.
void* library() {
    static void* const handle = dlopen(PLIANT_GMSH_LIBRARY, RTLD_LAZY | RTLD_LOCAL);
    if (handle == nullptr)
        throw LibraryMissing("shapes and surfaces are meshed by Gmsh, which cannot be loaded (" + last_loader_error() +
                             "); install " PLIANT_GMSH_LIBRARY);
    return handle;
}

void* symbol(const char* name) {
    void* const found = dlsym(library(), name);
    if (found == nullptr) throw LibraryMissing(PLIANT_GMSH_LIBRARY " is of another version: " + last_loader_error());
    return found;
}

/// A function of gmshc.h, looked up once.
#define PLIANT_GMSH(name)                                                              \
    ([] {                                                                              \
        static auto* const entry = reinterpret_cast<decltype(&::name)>(symbol(#name)); \
        return entry;                                                                  \
    }())

/// Memory that Gmsh gave away.
template <class T>
struct Given {
    T* data = nullptr;
    std::size_t count = 0;

    Given() = default;
    ~Given() { PLIANT_GMSH(gmshFree)(data); }
    Given(const Given&) = delete;
    Given& operator=(const Given&) = delete;

    [[nodiscard]] std::vector<T> vector() const { return std::vector<T>(data, data + count); }
};

std::string text(const Given<char>& given) {
    return given.data != nullptr ? given.data : "";
}

/// Calls a function whose last argument is where it tells of an error.
template <class Function, class... Arguments>
auto call(Function* function, Arguments... arguments) {
    int failed = 0;
    const auto check = [&] {
        if (failed == 0) return;
        Given<char> reason;
        int ignored = 0;
        PLIANT_GMSH(gmshLoggerGetLastError)(&reason.data, &ignored);
        const std::string words = text(reason);
        throw std::runtime_error(words.empty() ? "it failed without a reason" : words);
    };
    if constexpr (std::is_void_v<decltype(function(arguments..., &failed))>) {
        function(arguments..., &failed);
        check();
    } else {
        const auto result = function(arguments..., &failed);
        check();
        return result;
    }
}

std::vector<int> flat(const Entities& entities) {
    std::vector<int> numbers;
    numbers.reserve(2 * entities.size());
    for (const auto& [dimension, tag] : entities) numbers.insert(numbers.end(), {dimension, tag});
    return numbers;
}

Entities entities(const int* numbers, std::size_t count) {
    Entities pairs;
    for (std::size_t i = 0; i + 1 < count; i += 2) pairs.emplace_back(numbers[i], numbers[i + 1]);
    return pairs;
}

Entities entities(const Given<int>& given) {
    return entities(given.data, given.count);
}

}  // namespace

void initialize() {
    call(PLIANT_GMSH(gmshInitialize), 0, nullptr, 0);
}

namespace {

/// What Gmsh's C interface knows by address alone.
model::mesh::SizeCallback& size_callback() {
    static model::mesh::SizeCallback held;
    return held;
}

}  // namespace

void finalize() {
    call(PLIANT_GMSH(gmshFinalize));
    size_callback() = {};
}

void option::set_number(const char* name, double value) {
    call(PLIANT_GMSH(gmshOptionSetNumber), name, value);
}

namespace model {

void add(const char* name) {
    call(PLIANT_GMSH(gmshModelAdd), name);
}

Entities get_entities(int dimension) {
    Given<int> found;
    call(PLIANT_GMSH(gmshModelGetEntities), &found.data, &found.count, dimension);
    return entities(found);
}

std::string get_entity_name(int dimension, int tag) {
    Given<char> name;
    call(PLIANT_GMSH(gmshModelGetEntityName), dimension, tag, &name.data);
    return text(name);
}

Entities get_boundary(const Entities& of, bool combined) {
    std::vector<int> in = flat(of);
    Given<int> found;
    call(PLIANT_GMSH(gmshModelGetBoundary), in.data(), in.size(), &found.data, &found.count, int{combined}, 0, 0);
    return entities(found);
}

int add_discrete_entity(int dimension) {
    return call(PLIANT_GMSH(gmshModelAddDiscreteEntity), dimension, -1, nullptr, std::size_t{0});
}

Projection get_closest_point(int dimension, int tag, std::vector<double> coordinates) {
    Given<double> closest;
    Given<double> parameters;
    call(PLIANT_GMSH(gmshModelGetClosestPoint), dimension, tag, coordinates.data(), coordinates.size(), &closest.data,
         &closest.count, &parameters.data, &parameters.count);
    return {closest.vector(), parameters.vector()};
}

std::vector<double> get_normal(int tag, std::vector<double> parameters) {
    Given<double> normal;
    call(PLIANT_GMSH(gmshModelGetNormal), tag, parameters.data(), parameters.size(), &normal.data, &normal.count);
    return normal.vector();
}

namespace mesh {

void add_nodes(int dimension, int tag, std::vector<std::size_t> tags, std::vector<double> coordinates) {
    call(PLIANT_GMSH(gmshModelMeshAddNodes), dimension, tag, tags.data(), tags.size(), coordinates.data(),
         coordinates.size(), nullptr, std::size_t{0});
}

void add_elements_by_type(int tag, int type, std::vector<std::size_t> tags, std::vector<std::size_t> nodes) {
    call(PLIANT_GMSH(gmshModelMeshAddElementsByType), tag, type, tags.data(), tags.size(), nodes.data(), nodes.size());
}

void classify_surfaces(double angle_rad, bool boundary, bool for_reparametrization, double curve_angle_rad) {
    call(PLIANT_GMSH(gmshModelMeshClassifySurfaces), angle_rad, int{boundary}, int{for_reparametrization},
         curve_angle_rad, 0);
}

void create_geometry() {
    call(PLIANT_GMSH(gmshModelMeshCreateGeometry), nullptr, std::size_t{0});
}

void generate(int dimension) {
    call(PLIANT_GMSH(gmshModelMeshGenerate), dimension);
}

void set_order(int order) {
    call(PLIANT_GMSH(gmshModelMeshSetOrder), order);
}

void set_size_callback(SizeCallback callback) {
    size_callback() = std::move(callback);
    const auto forward = [](int dimension, int tag, double x, double y, double z, void* held) {
        return (*static_cast<SizeCallback*>(held))(dimension, tag, x, y, z);
    };
    call(PLIANT_GMSH(gmshModelMeshSetSizeCallback), forward, static_cast<void*>(&size_callback()));
}

Elements get_elements_by_type(int type, int tag) {
    Given<std::size_t> tags;
    Given<std::size_t> nodes;
    call(PLIANT_GMSH(gmshModelMeshGetElementsByType), type, &tags.data, &tags.count, &nodes.data, &nodes.count, tag,
         std::size_t{0}, std::size_t{1});
    return {tags.vector(), nodes.vector()};
}

std::vector<double> get_node(std::size_t tag) {
    Given<double> at;
    Given<double> parameters;
    call(PLIANT_GMSH(gmshModelMeshGetNode), tag, &at.data, &at.count, &parameters.data, &parameters.count);
    return at.vector();
}

Nodes get_nodes() {
    Given<std::size_t> tags;
    Given<double> coordinates;
    Given<double> parameters;
    call(PLIANT_GMSH(gmshModelMeshGetNodes), &tags.data, &tags.count, &coordinates.data, &coordinates.count,
         &parameters.data, &parameters.count, -1, -1, 0, 0);
    return {tags.vector(), coordinates.vector()};
}

}  // namespace mesh

namespace geo {

int add_volume(std::vector<int> shells) {
    return call(PLIANT_GMSH(gmshModelGeoAddVolume), shells.data(), shells.size(), -1);
}

int add_surface_loop(std::vector<int> surfaces) {
    return call(PLIANT_GMSH(gmshModelGeoAddSurfaceLoop), surfaces.data(), surfaces.size(), -1);
}

void synchronize() {
    call(PLIANT_GMSH(gmshModelGeoSynchronize));
}

}  // namespace geo

namespace occ {

int add_box(double x, double y, double z, double dx, double dy, double dz) {
    return call(PLIANT_GMSH(gmshModelOccAddBox), x, y, z, dx, dy, dz, -1);
}

int add_sphere(double x, double y, double z, double radius) {
    constexpr double quarter = 1.57079632679489661923;
    return call(PLIANT_GMSH(gmshModelOccAddSphere), x, y, z, radius, -1, -quarter, quarter, 4 * quarter);
}

int add_cylinder(double x, double y, double z, double dx, double dy, double dz, double radius) {
    constexpr double turn = 6.28318530717958647692;
    return call(PLIANT_GMSH(gmshModelOccAddCylinder), x, y, z, dx, dy, dz, radius, -1, turn);
}

int add_point(double x, double y, double z) {
    return call(PLIANT_GMSH(gmshModelOccAddPoint), x, y, z, 0.0, -1);
}

int add_line(int start, int end) {
    return call(PLIANT_GMSH(gmshModelOccAddLine), start, end, -1);
}

int add_curve_loop(std::vector<int> curves) {
    return call(PLIANT_GMSH(gmshModelOccAddCurveLoop), curves.data(), curves.size(), -1);
}

int add_plane_surface(std::vector<int> loops) {
    return call(PLIANT_GMSH(gmshModelOccAddPlaneSurface), loops.data(), loops.size(), -1);
}

int add_surface_loop(std::vector<int> surfaces) {
    return call(PLIANT_GMSH(gmshModelOccAddSurfaceLoop), surfaces.data(), surfaces.size(), -1, 0);
}

int add_volume(std::vector<int> shells) {
    return call(PLIANT_GMSH(gmshModelOccAddVolume), shells.data(), shells.size(), -1);
}

Entities extrude(const Entities& what, double dx, double dy, double dz) {
    std::vector<int> in = flat(what);
    Given<int> out;
    call(PLIANT_GMSH(gmshModelOccExtrude), in.data(), in.size(), dx, dy, dz, &out.data, &out.count, nullptr,
         std::size_t{0}, nullptr, std::size_t{0}, 0);
    return entities(out);
}

namespace {

template <class Function>
Outcome combine(Function* function, const Entities& objects, const Entities& tools) {
    std::vector<int> in = flat(objects);
    std::vector<int> with = flat(tools);
    Given<int> out;
    Given<int*> lists;
    Given<std::size_t> lengths;
    std::size_t parts = 0;
    call(function, in.data(), in.size(), with.data(), with.size(), &out.data, &out.count, &lists.data, &lengths.data,
         &parts, -1, 1, 1);
    Outcome outcome{entities(out), {}};
    for (std::size_t i = 0; i < parts; ++i) {
        outcome.became.push_back(entities(lists.data[i], lengths.data[i]));
        PLIANT_GMSH(gmshFree)(lists.data[i]);
    }
    return outcome;
}

}  // namespace

Outcome fuse(const Entities& objects, const Entities& tools) {
    return combine(PLIANT_GMSH(gmshModelOccFuse), objects, tools);
}

Outcome cut(const Entities& objects, const Entities& tools) {
    return combine(PLIANT_GMSH(gmshModelOccCut), objects, tools);
}

Outcome intersect(const Entities& objects, const Entities& tools) {
    return combine(PLIANT_GMSH(gmshModelOccIntersect), objects, tools);
}

Outcome fragment(const Entities& objects, const Entities& tools) {
    return combine(PLIANT_GMSH(gmshModelOccFragment), objects, tools);
}

Entities copy(const Entities& what) {
    std::vector<int> in = flat(what);
    Given<int> out;
    call(PLIANT_GMSH(gmshModelOccCopy), in.data(), in.size(), &out.data, &out.count);
    return entities(out);
}

void translate(const Entities& what, double dx, double dy, double dz) {
    std::vector<int> in = flat(what);
    call(PLIANT_GMSH(gmshModelOccTranslate), in.data(), in.size(), dx, dy, dz);
}

void rotate(const Entities& what, double x, double y, double z, double ax, double ay, double az, double angle_rad) {
    std::vector<int> in = flat(what);
    call(PLIANT_GMSH(gmshModelOccRotate), in.data(), in.size(), x, y, z, ax, ay, az, angle_rad);
}

void dilate(const Entities& what, double factor) {
    std::vector<int> in = flat(what);
    call(PLIANT_GMSH(gmshModelOccDilate), in.data(), in.size(), 0.0, 0.0, 0.0, factor, factor, factor);
}

void remove(const Entities& what, bool recursive) {
    std::vector<int> in = flat(what);
    call(PLIANT_GMSH(gmshModelOccRemove), in.data(), in.size(), int{recursive});
}

Entities import_shapes(const std::string& file) {
    Given<int> out;
    call(PLIANT_GMSH(gmshModelOccImportShapes), file.c_str(), &out.data, &out.count, 1, "step");
    return entities(out);
}

std::pair<std::vector<double>, std::vector<double>> get_bounding_box(int dimension, int tag) {
    std::vector<double> low(3);
    std::vector<double> high(3);
    call(PLIANT_GMSH(gmshModelOccGetBoundingBox), dimension, tag, &low[0], &low[1], &low[2], &high[0], &high[1],
         &high[2]);
    return {low, high};
}

double get_mass(int dimension, int tag) {
    double mass = 0;
    call(PLIANT_GMSH(gmshModelOccGetMass), dimension, tag, &mass);
    return mass;
}

void synchronize() {
    call(PLIANT_GMSH(gmshModelOccSynchronize));
}

}  // namespace occ
}  // namespace model

}  // namespace pliant::mesh::gmsh
