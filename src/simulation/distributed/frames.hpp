// Frames for ParaView: HDF5 files that all ranks write together, and the XDMF file that describes them.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "simulation/distributed/distributed_equilibrium.hpp"
#include "simulation/distributed/file_order.hpp"

namespace pliant::sim::distributed {

/// mesh.h5 in a folder: tets (m, 4 or 10), region (m) and material (m) of each. Called by root
/// alone, before the robot is distributed.
[[nodiscard]] Status write_frame_mesh(const std::filesystem::path& folder, const Description& description);

/// Nodes and tets are in the order of the whole mesh: the files are the same, to rounding, on any number of ranks.
class Frames {
public:
    /// `system` must outlive it. The folder holds mesh.h5.
    Frames(const DistributedEquilibrium& system, std::filesystem::path folder);

    /// 0007.h5 of step 7: points_mm and displacement_mm (n, 3), J, von_mises_kPa, max_stretch, energy_density_kPa (m).
    /// `x`: positions of the local nodes. Collective.
    [[nodiscard]] Status write(int step, const Eigen::VectorXd& x);

private:
    const DistributedEquilibrium& system_;
    std::filesystem::path folder_;
    FileOrder nodes_, tets_;
};

/// A step that has a frame.
struct FrameTime {
    int step = 0;
    double time = 0;
};
/// Contents of frames.xdmf, which is beside the folder `frames`.
[[nodiscard]] std::string frames_xdmf(const std::string& robot, int nodes, int tets, int order,
                                      const std::vector<FrameTime>& steps);

}  // namespace pliant::sim::distributed
