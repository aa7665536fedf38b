// The whole program of a robot, run like `pliant simulate`, for playback on the page: in seconds if the robot moves in
// time.
#pragma once

#include <memory>
#include <set>
#include <string>

#include "base/core/progress.hpp"
#include "simulation/run/trajectory.hpp"
#include "studio/simulate/simulation_session.hpp"

namespace pliant::studio {

class Motion {
public:
    /// Errors: not even one step converged, with the reason; cancelled.
    [[nodiscard]] static Result<std::shared_ptr<const Motion>> run(std::shared_ptr<const Built> built,
                                                                   Progress& progress);
    [[nodiscard]] std::size_t count() const { return trajectory_.steps.size(); }
    /// {"steps", "duration", "timed", "message": why it stopped before its end, "warnings"}
    [[nodiscard]] std::string json() const;
    /// A packet as of GET /api/frame. Precondition: k < count().
    [[nodiscard]] std::string frame(std::size_t k, const std::set<std::string>& fields) const;

private:
    Motion(std::shared_ptr<const Built> built, sim::Trajectory trajectory)
        : built_(std::move(built)), trajectory_(std::move(trajectory)) {}
    std::shared_ptr<const Built> built_;
    sim::Trajectory trajectory_;
};

}  // namespace pliant::studio
