// The only file that includes gmsh.h.
#include "geometry/meshing/gmsh_calls.hpp"

#include <gmsh.h>

namespace pliant::mesh::gmsh {

void initialize() {
    ::gmsh::initialize();
}

void finalize() {
    ::gmsh::finalize();
}

void option::set_number(const char* name, double value) {
    ::gmsh::option::setNumber(name, value);
}

namespace model {

namespace api = ::gmsh::model;

void add(const char* name) {
    api::add(name);
}

Entities get_entities(int dimension) {
    Entities found;
    api::getEntities(found, dimension);
    return found;
}

std::string get_entity_name(int dimension, int tag) {
    std::string name;
    api::getEntityName(dimension, tag, name);
    return name;
}

Entities get_boundary(const Entities& of, bool combined) {
    Entities found;
    api::getBoundary(of, found, combined, false, false);
    return found;
}

int add_discrete_entity(int dimension) {
    return api::addDiscreteEntity(dimension);
}

Projection get_closest_point(int dimension, int tag, std::vector<double> coordinates) {
    Projection found;
    api::getClosestPoint(dimension, tag, coordinates, found.coordinates, found.parameters);
    return found;
}

std::string get_type(int dimension, int tag) {
    std::string type;
    api::getType(dimension, tag, type);
    return type;
}

std::vector<double> get_curvature(int tag, const std::vector<double>& parameters) {
    std::vector<double> curvatures;
    api::getCurvature(2, tag, parameters, curvatures);
    return curvatures;
}

ParameterBounds get_parametrization_bounds(int dimension, int tag) {
    ParameterBounds found;
    api::getParametrizationBounds(dimension, tag, found.low, found.high);
    return found;
}

std::vector<double> get_normal(int tag, std::vector<double> parameters) {
    std::vector<double> normal;
    api::getNormal(tag, parameters, normal);
    return normal;
}

namespace mesh {

void add_nodes(int dimension, int tag, std::vector<std::size_t> tags, std::vector<double> coordinates) {
    api::mesh::addNodes(dimension, tag, tags, coordinates);
}

void add_elements_by_type(int tag, int type, std::vector<std::size_t> tags, std::vector<std::size_t> nodes) {
    api::mesh::addElementsByType(tag, type, tags, nodes);
}

void classify_surfaces(double angle_rad, bool boundary, bool for_reparametrization, double curve_angle_rad) {
    api::mesh::classifySurfaces(angle_rad, boundary, for_reparametrization, curve_angle_rad, false);
}

void create_geometry() {
    api::mesh::createGeometry();
}

void generate(int dimension) {
    api::mesh::generate(dimension);
}

void set_order(int order) {
    api::mesh::setOrder(order);
}

void set_size_callback(SizeCallback callback) {
    api::mesh::setSizeCallback(callback);
}

Elements get_elements_by_type(int type, int tag) {
    Elements found;
    api::mesh::getElementsByType(type, found.tags, found.nodes, tag);
    return found;
}

std::vector<double> get_node(std::size_t tag) {
    std::vector<double> at;
    std::vector<double> parameters;
    api::mesh::getNode(tag, at, parameters);
    return at;
}

Nodes get_nodes() {
    Nodes found;
    std::vector<double> parameters;
    api::mesh::getNodes(found.tags, found.coordinates, parameters, -1, -1, false, false);
    return found;
}

}  // namespace mesh

namespace geo {

int add_volume(std::vector<int> shells) {
    return api::geo::addVolume(shells);
}

int add_surface_loop(std::vector<int> surfaces) {
    return api::geo::addSurfaceLoop(surfaces);
}

void synchronize() {
    api::geo::synchronize();
}

}  // namespace geo

namespace occ {

int add_box(double x, double y, double z, double dx, double dy, double dz) {
    return api::occ::addBox(x, y, z, dx, dy, dz);
}

int add_sphere(double x, double y, double z, double radius) {
    return api::occ::addSphere(x, y, z, radius);
}

int add_cylinder(double x, double y, double z, double dx, double dy, double dz, double radius) {
    return api::occ::addCylinder(x, y, z, dx, dy, dz, radius);
}

int add_point(double x, double y, double z) {
    return api::occ::addPoint(x, y, z);
}

int add_line(int start, int end) {
    return api::occ::addLine(start, end);
}

int add_curve_loop(std::vector<int> curves) {
    return api::occ::addCurveLoop(curves);
}

int add_plane_surface(std::vector<int> loops) {
    return api::occ::addPlaneSurface(loops);
}

int add_surface_loop(std::vector<int> surfaces) {
    return api::occ::addSurfaceLoop(surfaces);
}

int add_volume(std::vector<int> shells) {
    return api::occ::addVolume(shells);
}

Entities extrude(const Entities& what, double dx, double dy, double dz) {
    Entities out;
    api::occ::extrude(what, dx, dy, dz, out);
    return out;
}

Outcome fuse(const Entities& objects, const Entities& tools) {
    Outcome outcome;
    api::occ::fuse(objects, tools, outcome.entities, outcome.became);
    return outcome;
}

Outcome cut(const Entities& objects, const Entities& tools) {
    Outcome outcome;
    api::occ::cut(objects, tools, outcome.entities, outcome.became);
    return outcome;
}

Outcome intersect(const Entities& objects, const Entities& tools) {
    Outcome outcome;
    api::occ::intersect(objects, tools, outcome.entities, outcome.became);
    return outcome;
}

Outcome fragment(const Entities& objects, const Entities& tools) {
    Outcome outcome;
    api::occ::fragment(objects, tools, outcome.entities, outcome.became);
    return outcome;
}

Entities copy(const Entities& what) {
    Entities out;
    api::occ::copy(what, out);
    return out;
}

void translate(const Entities& what, double dx, double dy, double dz) {
    api::occ::translate(what, dx, dy, dz);
}

void rotate(const Entities& what, double x, double y, double z, double ax, double ay, double az, double angle_rad) {
    api::occ::rotate(what, x, y, z, ax, ay, az, angle_rad);
}

void dilate(const Entities& what, double factor) {
    api::occ::dilate(what, 0, 0, 0, factor, factor, factor);
}

void remove(const Entities& what, bool recursive) {
    api::occ::remove(what, recursive);
}

Entities get_entities(int dimension) {
    Entities found;
    api::occ::getEntities(found, dimension);
    return found;
}

Entities import_shapes(const std::string& file) {
    Entities out;
    api::occ::importShapes(file, out, true, "step");
    return out;
}

std::pair<std::vector<double>, std::vector<double>> get_bounding_box(int dimension, int tag) {
    std::vector<double> low(3);
    std::vector<double> high(3);
    api::occ::getBoundingBox(dimension, tag, low[0], low[1], low[2], high[0], high[1], high[2]);
    return {low, high};
}

double get_mass(int dimension, int tag) {
    double mass = 0;
    api::occ::getMass(dimension, tag, mass);
    return mass;
}

void synchronize() {
    api::occ::synchronize();
}

}  // namespace occ
}  // namespace model

}  // namespace pliant::mesh::gmsh
