// A robot as the solver sees it: built once from a description, validated, immutable.
#pragma once

#include <memory>
#include <vector>

#include "simulation/model/held_nodes.hpp"
#include "simulation/model/object_points.hpp"
#include "simulation/parts/description.hpp"

namespace pliant::sim {

class Elements;

class Model {
public:
    /// Checks indices, weights, volumes, supports (HeldNodes), objects, and that something holds the robot, unless it
    /// may be free.
    [[nodiscard]] static Result<Model> create(Description description);
    Model(Model&&) noexcept;
    Model& operator=(Model&&) noexcept;
    ~Model();

    [[nodiscard]] const Description& description() const { return description_; }
    [[nodiscard]] const mesh::TetMesh& mesh() const { return description_.mesh; }
    [[nodiscard]] const Elements& elements() const { return *elements_; }
    /// The contact model, null if nothing can touch. `met`: the robot has met itself, if self-contact is deferred until
    /// then.
    [[nodiscard]] const contact::Contact* contact(bool met) const { return met && met_ ? met_.get() : contact_.get(); }
    /// The surfaces of the bodies, for intersection checks; those of contact() if there is contact.
    [[nodiscard]] const contact::Contact& surfaces() const { return surfaces_ ? *surfaces_ : *contact(true); }
    [[nodiscard]] int node_count() const { return static_cast<int>(description_.mesh.points.size()); }
    [[nodiscard]] int free_count() const { return free_count_; }
    /// (n), index among the free nodes, or -1 for nodes held in all directions. Rollers count as free.
    [[nodiscard]] const std::vector<int>& free_index() const { return free_index_; }
    [[nodiscard]] const HeldNodes& held() const { return *held_; }
    /// The objects as affine bodies, for forces, and the points of their surfaces, for contact.
    [[nodiscard]] const std::vector<AffineBody>& objects() const { return objects_; }
    [[nodiscard]] const ObjectPoints& object_points() const { return object_points_; }
    /// The nodes of each connected piece of tets that no support holds, ascending.
    [[nodiscard]] const std::vector<std::vector<int>>& free_pieces() const { return free_pieces_; }

private:
    Model();
    [[nodiscard]] Status make_contact();
    void make_objects();
    Description description_;
    std::unique_ptr<Elements> elements_;
    std::unique_ptr<contact::Contact> contact_;
    std::unique_ptr<contact::Contact> met_;       ///< with self-contact, if that is deferred until needed
    std::unique_ptr<contact::Contact> surfaces_;  ///< if there is no contact
    std::unique_ptr<HeldNodes> held_;
    std::vector<AffineBody> objects_;
    ObjectPoints object_points_;
    std::vector<std::vector<int>> free_pieces_;
    std::vector<int> free_index_;
    int free_count_ = 0;
};

}  // namespace pliant::sim
