#include "pliant/view.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <utility>

#include "base/linalg/vectors.hpp"
#include "library/base/calls.hpp"
#include "library/simulation/data.hpp"
#include "presentation/scene/scene.hpp"

namespace pliant {

struct View::Work {
    explicit Work(std::shared_ptr<const Model::Data> data)
        : model(std::move(data)), scene(model->scene.robot, model->scene.model) {}

    /// mm
    [[nodiscard]] std::string markers(std::span<const double> x) const {
        std::vector<std::string> places;
        for (const sim::Marker& marker : model->scene.model.description().markers) {
            const Vec3 p = sim::position(marker.point, x);
            places.push_back(fmt::format("[{},{},{}]", 1e3 * p.x, 1e3 * p.y, 1e3 * p.z));
        }
        return fmt::format("[{}]", fmt::join(places, ","));
    }

    [[nodiscard]] std::string frame(std::vector<Vec3> points, double time) const {
        const std::string head =
            fmt::format(R"({{"revision":1,"time":{},"markers":{},"obstacles":{}}})", time,
                        markers(library::numbers_of(points)), scene.obstacle_offsets(time, points));
        sim::Step step;
        step.positions = std::move(points);
        return scene.frame(step, {"J", "von_mises", "stretch", "energy"}, head);
    }

    std::shared_ptr<const Model::Data> model;
    view::Scene scene;
};

View::View(const Model& model) : work_(std::make_unique<Work>(model.data())) {}
View::View(View&&) noexcept = default;
View& View::operator=(View&&) noexcept = default;
View::~View() = default;

std::string View::scene() const {
    return work_->scene.packet(R"(,"revision":1)");
}

std::string View::frame(const State& state) const {
    if (state.data().model != work_->model) throw Failure(Failure::Kind::input, "the state is one of another model");
    return work_->frame(linalg::points_of(state.data().robot.x()), state.data().robot.inputs.time);
}

std::string View::frame(const std::vector<Point>& positions, double time) const {
    if (static_cast<int>(positions.size()) != work_->model->scene.model.node_count())
        throw Failure(Failure::Kind::input, fmt::format("{} positions for {} nodes", positions.size(),
                                                        work_->model->scene.model.node_count()));
    std::vector<Vec3> points;
    for (const Point& p : positions) {
        points.push_back({p[0], p[1], p[2]});
        if (!is_finite(points.back())) throw Failure(Failure::Kind::input, "a position is not finite");
    }
    if (!std::isfinite(time)) throw Failure(Failure::Kind::input, "the time is not finite");
    return work_->frame(std::move(points), time);
}

}  // namespace pliant
