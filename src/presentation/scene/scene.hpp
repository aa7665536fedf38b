// Data for drawing a robot on the page: surfaces of every material, cables, chambers, supports, obstacles, markers.
// Built once for a model; a frame moves it. Output lengths are in mm.
#pragma once

#include <set>
#include <span>
#include <string>
#include <vector>

#include "presentation/draw/colour.hpp"
#include "presentation/draw/obstacle.hpp"
#include "presentation/draw/surface.hpp"
#include "presentation/report/simulation.hpp"
#include "presentation/scene/packet.hpp"
#include "robot/description/robot.hpp"
#include "simulation/model/model.hpp"
#include "simulation/run/trajectory.hpp"

namespace pliant::view {

/// True for a field that a frame can carry in addition to positions; the page itself computes displacement.
[[nodiscard]] bool is_field(const std::string& name);

class Scene {
public:
    /// Both must outlive it.
    Scene(const robot::Robot& robot, const sim::Model& model);

    /// Everything that does not move, docs/reference/studio.md; `extra` is added to the head, JSON members with a comma
    /// in front, or nothing.
    [[nodiscard]] std::string packet(const std::string& extra) const;
    /// Positions, cables, chambers and the requested fields. `head`: JSON of the frame.
    [[nodiscard]] std::string frame(const sim::Step& step, const std::set<std::string>& fields,
                                    const std::string& head) const;
    /// Positions of the obstacles, JSON: [[x, y, z] offset in mm]; then of the objects, for nodes at `positions`: [x,
    /// y, z, and the unit quaternion x, y, z, w of the rotation applied first].
    [[nodiscard]] std::string obstacle_offsets(double time, std::span<const Vec3> positions) const;

    [[nodiscard]] std::size_t vertex_count() const { return surface_.vertex_node.size(); }
    [[nodiscard]] int node_of_vertex(std::size_t vertex) const { return surface_.vertex_node[vertex]; }
    /// (regions), index into the robot's materials, -1: none
    [[nodiscard]] const std::vector<int>& region_material() const { return region_material_; }

private:
    void add_materials();
    void add_grades();
    void add_field(Packet& packet, const std::string& name, const std::vector<double>& tets) const;
    [[nodiscard]] std::string head() const;

    const robot::Robot& robot_;
    const sim::Model& model_;
    std::vector<int> region_material_;
    report::Surface surface_;              ///< of all materials, one after the other
    std::vector<report::Surface> parts_;   ///< (materials)
    std::vector<std::vector<int>> shown_;  ///< (materials) region_material with all other materials void
    std::vector<std::uint32_t> material_;  ///< (vertices)
    std::vector<std::uint32_t> other_;     ///< (vertices) second material of a graded body, else its own
    std::vector<float> share_;             ///< (vertices) share of the second material; empty: no body is graded
    std::vector<report::Obstacle> obstacles_;
};

/// The sRGB colour a material is drawn in: its own, or the palette's.
[[nodiscard]] report::Colour colour_of(const robot::Robot& robot, std::size_t material);

}  // namespace pliant::view
