// Wrappers for the Gmsh functions that this folder uses; they return results instead of filling arguments. Names follow
// gmsh.h. Entities are pairs of dimension and tag. A failing call throws std::runtime_error with Gmsh's message.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace pliant::mesh::gmsh {

using Entities = std::vector<std::pair<int, int>>;

void initialize();
void finalize();

namespace option {
void set_number(const char* name, double value);
}

namespace model {
void add(const char* name);
Entities get_entities(int dimension);
/// The name of an entity from its CAD file; "" if unnamed.
std::string get_entity_name(int dimension, int tag);
Entities get_boundary(const Entities& of, bool combined);
int add_discrete_entity(int dimension);
struct Projection {
    std::vector<double> coordinates, parameters;
};
Projection get_closest_point(int dimension, int tag, std::vector<double> coordinates);
std::vector<double> get_normal(int tag, std::vector<double> parameters);
/// What an entity is, in Gmsh's words, as "Plane", "Sphere" or "Cylinder".
std::string get_type(int dimension, int tag);
/// The largest curvature of a surface at each of its parameters (2 n); 0 where it is flat.
std::vector<double> get_curvature(int tag, const std::vector<double>& parameters);
struct ParameterBounds {
    std::vector<double> low, high;
};
ParameterBounds get_parametrization_bounds(int dimension, int tag);

namespace mesh {
struct Nodes {
    std::vector<std::size_t> tags;
    std::vector<double> coordinates;  ///< (3 n)
};
struct Elements {
    std::vector<std::size_t> tags, nodes;
};
/// Edge length by dimension, tag and position.
using SizeCallback = std::function<double(int, int, double, double, double)>;

void add_nodes(int dimension, int tag, std::vector<std::size_t> tags, std::vector<double> coordinates);
void add_elements_by_type(int tag, int type, std::vector<std::size_t> tags, std::vector<std::size_t> nodes);
void classify_surfaces(double angle_rad, bool boundary, bool for_reparametrization, double curve_angle_rad);
void create_geometry();
void generate(int dimension);
void set_order(int order);
/// Stays set until the library is finalised.
void set_size_callback(SizeCallback callback);
Elements get_elements_by_type(int type, int tag);
std::vector<double> get_node(std::size_t tag);
Nodes get_nodes();
}  // namespace mesh

namespace geo {
int add_volume(std::vector<int> shells);
int add_surface_loop(std::vector<int> surfaces);
void synchronize();
}  // namespace geo

namespace occ {
int add_box(double x, double y, double z, double dx, double dy, double dz);
int add_sphere(double x, double y, double z, double radius);
int add_cylinder(double x, double y, double z, double dx, double dy, double dz, double radius);
int add_point(double x, double y, double z);
int add_line(int start, int end);
int add_curve_loop(std::vector<int> curves);
int add_plane_surface(std::vector<int> loops);
int add_surface_loop(std::vector<int> surfaces);
int add_volume(std::vector<int> shells);
Entities extrude(const Entities& what, double dx, double dy, double dz);

/// Result of a Boolean operation: the remaining entities, and what each input became. Objects and tools are deleted.
struct Outcome {
    Entities entities;
    std::vector<Entities> became;
};
Outcome fuse(const Entities& objects, const Entities& tools);
Outcome cut(const Entities& objects, const Entities& tools);
Outcome intersect(const Entities& objects, const Entities& tools);
Outcome fragment(const Entities& objects, const Entities& tools);

Entities copy(const Entities& what);
void translate(const Entities& what, double dx, double dy, double dz);
void rotate(const Entities& what, double x, double y, double z, double ax, double ay, double az, double angle_rad);
/// Uniform scaling about the origin.
void dilate(const Entities& what, double factor);
void remove(const Entities& what, bool recursive);
/// What Open CASCADE has of a dimension, also before synchronize().
Entities get_entities(int dimension);
/// Solids of a STEP file or, if it has none, its shapes of highest dimension.
Entities import_shapes(const std::string& file);
/// Minimum and maximum corner.
std::pair<std::vector<double>, std::vector<double>> get_bounding_box(int dimension, int tag);
double get_mass(int dimension, int tag);
void synchronize();
}  // namespace occ
}  // namespace model

}  // namespace pliant::mesh::gmsh
