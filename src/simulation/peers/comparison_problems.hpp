// Small robots that both Pliant and other codes solve: a bar, a beam, a cable finger and a block with an air chamber.
// Used by the tests that run CalculiX (*_peer_test.cpp), by bench/compare and by nothing else.
//
// `order` 1 or 2: linear or quadratic tets on the same straight mesh. Every problem has a marker "tip" that is a mean
// of corner nodes, so that it means the same for both orders.
#pragma once

#include "simulation/model/model.hpp"
#include "simulation/run/trajectory.hpp"

namespace pliant::sim::comparison {

/// 100 x 10 x 10 mm in 12 x 2 x 2 Kuhn cells; `hard` up to the middle, then `soft`. Both ends are held, the far one
/// moves by `strain` of the length (the thesis' tensile bar, its figure 3.5). "tip" is the interface in the middle.
[[nodiscard]] Description bar(int order, const material::Law& hard, const material::Law& soft, double strain);

/// 100 x 5 x 5 mm in `cells` x 2 x 2 Kuhn cells, clamped at x = 0, 0.06 N upwards spread over the far end.
[[nodiscard]] Description beam(int order, const material::Law& law, int cells);

/// How a cable or chamber acts: through its own constraint, or through the thesis' elements, which mesh the empty space
/// and scale their target shapes (T3.5, T3.6), with a stiffness relative to `law`.
enum class Drive { constraint, elements };

/// 60 x 6 x 9 mm with four V notches from the top, clamped at x = 0; a cable runs lengthwise at z = 6 mm through
/// nodes of the mesh, jumping the notches.
[[nodiscard]] Description cable_finger(int order, const material::Law& law, const CableTarget& target,
                                       Drive drive = Drive::constraint);

/// 30 x 10 x 10 mm, clamped at x = 0, with a closed empty box of 20 x 5 x 4 mm nearer to the bottom: it bends upwards
/// when it is inflated.
[[nodiscard]] Description air_block(int order, const material::Law& law, const ChamberTarget& target,
                                    Drive drive = Drive::constraint);

/// Length of cable 0, and volume of chamber 0, at node positions (n, 3).
[[nodiscard]] double cable_length(const Description& description, const std::vector<Vec3>& positions);
[[nodiscard]] double chamber_volume(const Description& description, const std::vector<Vec3>& positions);

/// Rest positions plus displacements, (n, 3).
[[nodiscard]] std::vector<Vec3> moved(const mesh::TetMesh& mesh, const std::vector<Vec3>& displacement);

/// Displacement of the marker "tip".
[[nodiscard]] Vec3 tip_displacement(const Description& description, const Step& step);

}  // namespace pliant::sim::comparison
