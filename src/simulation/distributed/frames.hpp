// The motion with its fields for ParaView: HDF5 that all ranks write together, and the XDMF that describes it.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "simulation/distributed/balance.hpp"
#include "simulation/distributed/file_order.hpp"

namespace pliant::sim::distributed {

/// mesh.h5 in a folder: tets (m, 4 or 10), region (m) and material (m) of each. For root alone, before the robot is
/// spread.
[[nodiscard]] Status write_frame_mesh(const std::filesystem::path& folder, const Description& description);

/// Nodes and tets are in the order of the whole mesh: the files are the same, to rounding, on any number of ranks.
class Frames {
public:
    /// `balance` must outlive it. The folder holds mesh.h5.
    Frames(const Balance& balance, std::filesystem::path folder);

    /// 0007.h5 of step 7: points_mm and displacement_mm (n, 3), J, von_mises_kPa, max_stretch, energy_density_kPa (m).
    /// `x`: positions of the known nodes. Collective.
    [[nodiscard]] Status write(int step, const Eigen::VectorXd& x);

private:
    const Balance& balance_;
    std::filesystem::path folder_;
    FileOrder nodes_, tets_;
};

/// A step of which there is a frame.
struct FrameTime {
    int step = 0;
    double time = 0;
};
/// What frames.xdmf beside the folder `frames` says of them.
[[nodiscard]] std::string frames_xdmf(const std::string& robot, int nodes, int tets, int order,
                                      const std::vector<FrameTime>& steps);

}  // namespace pliant::sim::distributed
