#include "robot/bodies/shape_motion.hpp"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/core/boxes.hpp"
#include "base/linalg/dense.hpp"
#include "geometry/shapes/surface_pieces.hpp"
#include "robot/description/regions.hpp"

namespace pliant::robot {
namespace {

using mesh::SurfacePiece;

/// Tolerance for a node on a surface, as a share of the robot's size.
constexpr double on_surface = 1e-6;

/// In metres.
std::vector<SurfacePiece> pieces_of(const Robot& robot) {
    std::vector<SurfacePiece> all;
    const auto add = [&](const mesh::Solid& solid) {
        for (SurfacePiece piece : mesh::surface_pieces(solid)) {
            piece.point = robot.unit_m * piece.point;
            piece.radius *= robot.unit_m;
            if (piece.kind == SurfacePiece::Kind::cylinder) piece.direction = robot.unit_m * piece.direction;
            for (auto& loop : piece.loops) {
                for (Vec3& p : loop) p = robot.unit_m * p;
            }
            all.push_back(std::move(piece));
        }
    };
    for (const Region& region : regions_of(robot)) {
        if (const auto* solid = std::get_if<mesh::Solid>(region.geometry)) add(*solid);
    }
    return all;
}

bool has_file_geometry(const Robot& robot) {
    return std::ranges::any_of(
        robot.bodies, [](const BodySpec& body) { return !std::holds_alternative<mesh::Solid>(body.geometry); });
}

/// Constraints of a node: v . normals = rates.
struct Held {
    Eigen::Matrix<double, Eigen::Dynamic, 3> normals;
    Eigen::VectorXd rates;
};

/// The free directions (3, free), and the smallest motion that satisfies the constraints.
struct Freedom {
    Eigen::Matrix<double, 3, Eigen::Dynamic> free;
    Eigen::Vector3d given = Eigen::Vector3d::Zero();
    double contradiction = 0;  ///< inconsistency of the constraints
};

Freedom freedom_of(const Held& held) {
    const auto [U, sigma, V] = linalg::svd(held.normals, linalg::SvdParts::square);
    constexpr double tangent = 1e-6;  // surfaces that meet at a smaller angle constrain only one direction
    Eigen::Index rank = 0;
    for (; rank < sigma.size() && sigma[rank] > tangent; ++rank) {
    }
    Freedom out;
    const Eigen::VectorXd along = U.transpose() * held.rates;
    for (Eigen::Index k = 0; k < rank; ++k) out.given += along[k] / sigma[k] * V.col(k);
    out.free = V.rightCols(3 - rank);
    out.contradiction = (held.normals * out.given - held.rates).cwiseAbs().maxCoeff();
    return out;
}

class Motion {
public:
    Motion(const Robot& robot, const DrawnAround& around, const mesh::TetMesh& mesh)
        : mesh_(mesh),
          now_(pieces_of(robot)),
          more_(pieces_of(around.more)),
          less_(pieces_of(around.less)),
          step_(around.step),
          from_file_(has_file_geometry(robot)),
          bodies_(robot.bodies.size()) {
        box_ = bounds_of(mesh.points);
    }

    [[nodiscard]] Result<std::vector<Vec3>> find() {
        if (more_.size() != now_.size() || less_.size() != now_.size())
            return input_error("it changes what the bodies are made of");
        if (Status status = check_files(); !status) return tl::unexpected(status.error());
        freedom_.resize(mesh_.points.size());
        if (Status status = hold_surface(); !status) return tl::unexpected(status.error());
        extend();
        place_middles();
        return std::move(motion_);
    }

private:
    [[nodiscard]] bool is_same(const SurfacePiece& a, const SurfacePiece& b) const {
        return norm(a.point - b.point) + norm(a.direction - b.direction) == 0;
    }

    [[nodiscard]] Status check_files() const {
        for (std::size_t k = 0; k < now_.size(); ++k) {
            if (now_[k].kind == SurfacePiece::Kind::drawn && !is_same(more_[k], less_[k]))
                return input_error("it moves geometry of a file, whose surface is not known as equations");
        }
        return {};
    }

    /// (nodes) true on the surface of a body, and where two regions meet.
    [[nodiscard]] std::vector<char> on_faces() const {
        std::vector<char> found(mesh_.points.size(), 0);
        const std::size_t width = mesh_.order == 2 ? 6 : 3;
        for (std::size_t r = 0; r < bodies_; ++r) {
            for (const mesh::Face& face : mesh::region_faces(mesh_, static_cast<int>(r))) {
                for (std::size_t i = 0; i < width; ++i) found[static_cast<std::size_t>(face.nodes[i])] = 1;
            }
        }
        return found;
    }

    [[nodiscard]] Held held_at(const Vec3& p) const {
        std::vector<std::pair<Vec3, double>> rows;
        const double within = on_surface * box_.diagonal();
        for (std::size_t k = 0; k < now_.size(); ++k) {
            if (!now_[k].holds(p, within)) continue;
            rows.emplace_back(now_[k].normal(p), -(more_[k].distance(p) - less_[k].distance(p)) / step_);
        }
        Held held{Eigen::MatrixXd(static_cast<Eigen::Index>(rows.size()), 3),
                  Eigen::VectorXd(static_cast<Eigen::Index>(rows.size()))};
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const auto& [n, rate] = rows[i];
            held.normals.row(static_cast<Eigen::Index>(i)) << n.x, n.y, n.z;
            held.rates[static_cast<Eigen::Index>(i)] = rate;
        }
        return held;
    }

    [[nodiscard]] Status hold_surface() {
        const std::vector<char> surface = on_faces();
        for (std::size_t n = 0; n < mesh_.points.size(); ++n) {
            Freedom& freedom = freedom_[n];
            freedom.free = Eigen::Matrix3d::Identity();
            if (surface[n] == 0) continue;
            const Held held = held_at(mesh_.points[n]);
            if (held.rates.size() == 0) {
                if (from_file_) freedom.free.resize(3, 0);
                continue;
            }
            freedom = freedom_of(held);
            fastest_ = std::max(fastest_, held.rates.cwiseAbs().maxCoeff());
        }
        constexpr double agreement = 1e-6;
        for (std::size_t n = 0; n < mesh_.points.size(); ++n) {
            if (freedom_[n].contradiction > agreement * fastest_)
                return input_error("surfaces that touch at ({:.6g}, {:.6g}, {:.6g}) mm move apart or into each other",
                                   1e3 * mesh_.points[n].x, 1e3 * mesh_.points[n].y, 1e3 * mesh_.points[n].z);
        }
        return {};
    }

    /// Extends the motion to all corner nodes: least squares of its gradient, on linear tets.
    void extend() {
        motion_.assign(mesh_.points.size(), Vec3{});
        if (fastest_ == 0) return;
        std::vector<Eigen::Index> first(mesh_.points.size(), -1);
        Eigen::Index unknowns = 0;
        for (std::size_t t = 0; t < mesh_.tet_count(); ++t) {
            for (std::size_t i = 0; i < 4; ++i) {
                const auto n = static_cast<std::size_t>(mesh_.tet(t)[i]);
                if (first[n] >= 0) continue;
                first[n] = unknowns;
                unknowns += freedom_[n].free.cols();
            }
        }
        std::vector<Eigen::Triplet<double>> entries;
        Eigen::VectorXd load = Eigen::VectorXd::Zero(unknowns);
        for (std::size_t t = 0; t < mesh_.tet_count(); ++t) add_tet(t, first, entries, load);
        Eigen::SparseMatrix<double> matrix(unknowns, unknowns);
        matrix.setFromTriplets(entries.begin(), entries.end());
        Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower | Eigen::Upper> solver;
        solver.setTolerance(1e-12);
        solver.compute(matrix);
        const Eigen::VectorXd found = unknowns > 0 ? Eigen::VectorXd(solver.solve(load)) : load;
        for (std::size_t n = 0; n < mesh_.points.size(); ++n) {
            if (first[n] < 0) continue;
            const Freedom& freedom = freedom_[n];
            const Eigen::Vector3d v = freedom.given + freedom.free * found.segment(first[n], freedom.free.cols());
            motion_[n] = {v.x(), v.y(), v.z()};
        }
    }

    void add_tet(std::size_t t, const std::vector<Eigen::Index>& first, std::vector<Eigen::Triplet<double>>& entries,
                 Eigen::VectorXd& load) const {
        const auto nodes = mesh_.tet(t);
        const auto point = [&](std::size_t i) { return mesh_.points[static_cast<std::size_t>(nodes[i])]; };
        const double volume = std::fabs(mesh::signed_tet_volume(point(0), point(1), point(2), point(3)));
        std::array<Vec3, 4> slopes;  // of barycentric coordinates
        for (std::size_t i = 0; i < 4; ++i) {
            const Vec3 a = point((i + 1) % 4), b = point((i + 2) % 4), c = point((i + 3) % 4);
            const Vec3 n = cross(b - a, c - a);
            slopes[i] = n / dot(n, point(i) - a);
        }
        for (std::size_t i = 0; i < 4; ++i) {
            const auto n = static_cast<std::size_t>(nodes[i]);
            for (std::size_t j = 0; j < 4; ++j) {
                const auto m = static_cast<std::size_t>(nodes[j]);
                const double weight = volume * dot(slopes[i], slopes[j]);
                const Eigen::MatrixXd block = weight * freedom_[n].free.transpose() * freedom_[m].free;
                for (Eigen::Index r = 0; r < block.rows(); ++r) {
                    for (Eigen::Index c = 0; c < block.cols(); ++c)
                        entries.emplace_back(first[n] + r, first[m] + c, block(r, c));
                }
                load.segment(first[n], block.rows()) -= weight * freedom_[n].free.transpose() * freedom_[m].given;
            }
        }
    }

    /// Mid-edge nodes: the mean of their ends, or on curved surfaces the motion of the surface.
    void place_middles() {
        if (mesh_.order != 2) return;
        constexpr std::array<std::array<std::size_t, 2>, 6> edges = {{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
        std::vector<char> done(mesh_.points.size(), 0);
        for (std::size_t t = 0; t < mesh_.tet_count(); ++t) {
            const auto nodes = mesh_.tet(t);
            for (std::size_t e = 0; e < 6; ++e) {
                const auto middle = static_cast<std::size_t>(nodes[4 + e]);
                if (std::exchange(done[middle], 1) != 0) continue;
                const Vec3 mean = 0.5 * (motion_[static_cast<std::size_t>(nodes[edges[e][0]])] +
                                         motion_[static_cast<std::size_t>(nodes[edges[e][1]])]);
                const Freedom& freedom = freedom_[middle];
                const Eigen::Vector3d m(mean.x, mean.y, mean.z);
                const Eigen::Vector3d v = freedom.given + freedom.free * (freedom.free.transpose() * m);
                motion_[middle] = {v.x(), v.y(), v.z()};
            }
        }
    }

    const mesh::TetMesh& mesh_;
    std::vector<SurfacePiece> now_, more_, less_;
    double step_;
    bool from_file_;
    std::size_t bodies_;
    Box3 box_;
    std::vector<Freedom> freedom_;  ///< (nodes)
    double fastest_ = 0;
    std::vector<Vec3> motion_;  ///< (nodes)
};

}  // namespace

Result<std::vector<Vec3>> shape_motion(const Robot& robot, const DrawnAround& around, const mesh::TetMesh& mesh) {
    if (robot.mesh.file) return std::vector<Vec3>(mesh.points.size());
    return Motion(robot, around, mesh).find();
}

}  // namespace pliant::robot
