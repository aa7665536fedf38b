#include "simulation/scene/build_sensors.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <set>

#include "base/linalg/vectors.hpp"
#include "simulation/scene/build_places.hpp"

namespace pliant::robot {
namespace {

Vec3 vec3(const Eigen::Vector3d& v) {
    return {v[0], v[1], v[2]};
}

class Builder {
public:
    Builder(ModelDraft& draft, const sim::Attacher& attacher) : draft_(draft), attacher_(attacher) {}

    void add(const SensorSpec& spec) {
        spec_ = &spec;
        failed_ = false;
        std::visit([&](const auto& what) { add(what); }, spec.what);
    }

private:
    template <class What>
    void keep(What what) {
        if (!failed_) draft_.description.sensors.push_back({spec_->name, std::move(what)});
    }

    void problem(const std::string& text) {
        draft_.problem(spec_->line, "sensor", spec_->name, text);
        failed_ = true;
    }

    sim::Attachment point(const Vec3& at) {
        auto on = carried(draft_, attacher_, at, {"sensor", "sensors", spec_->name, spec_->line, 0});
        failed_ = failed_ || !on;
        return on.value_or(sim::Attachment{});
    }

    sim::AttachedFrame frame(const Vec3& at, double radius) {
        (void)point(at);
        const double unit_m = draft_.robot.unit_m;
        auto on = attacher_.frame(unit_m * at, unit_m * radius, draft_.point_reach);
        if (on) return std::move(*on);
        if (!failed_) problem("the point lies on an object, which turns as one: give object = \"NAME\"");
        return {};
    }

    void add(const StrainSensorSpec& what) {
        sim::StrainSensor sensor;
        for (const Vec3& at : what.points) sensor.points.push_back(point(at));
        keep(std::move(sensor));
    }

    /// Axes with minimal rotation from section to section.
    void add(const BackboneSensorSpec& what) {
        sim::BackboneSensor sensor;
        Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
        for (std::size_t k = 0; k < what.points.size(); ++k) {
            sensor.sections.push_back(frame(what.points[k], what.radius));
            const Vec3& before = what.points[k == 0 ? 0 : k - 1];
            const Vec3& after = what.points[std::min(k + 1, what.points.size() - 1)];
            if (!(norm(after - before) > 0)) return problem("its points turn back");
            const Eigen::Vector3d along = linalg::vector(unit(after - before));
            const Eigen::Vector3d last = axes.col(2);
            axes = (Eigen::Quaterniond::FromTwoVectors(last, along).toRotationMatrix() * axes).eval();
            sensor.axes.push_back({vec3(axes.col(0)), vec3(axes.col(1)), vec3(axes.col(2))});
        }
        keep(std::move(sensor));
    }

    /// The triangles of the surface with all three corners inside its selector.
    void add(const ContactSensorSpec& what) {
        if (!draft_.description.contact)
            return problem("nothing can touch; give [contact], an [[obstacle]] or an [[object]]");
        const std::vector<int> nodes = caught_nodes(draft_, what.selector, "sensor", spec_->name, spec_->line);
        const std::set<int> caught(nodes.begin(), nodes.end());
        std::map<int, double> patch, owned;
        const auto& points = draft_.description.mesh.points;
        for (const auto& t : draft_.description.contact->surface.triangles) {
            const auto at = [&](std::size_t k) { return points[static_cast<std::size_t>(t[k])]; };
            const double third = norm(cross(at(1) - at(0), at(2) - at(0))) / 6;
            const bool inside = std::ranges::all_of(t, [&](int node) { return caught.contains(node); });
            for (const int node : t) {
                owned[node] += third;
                if (inside) patch[node] += third;
            }
        }
        sim::ContactSensor sensor;
        for (const auto& [node, area] : patch) {
            sensor.nodes.push_back(node);
            sensor.areas_m2.push_back(area);
            sensor.owned_m2.push_back(owned[node]);
        }
        if (sensor.nodes.empty()) return problem("catches no triangle of the surface; " + draft_.show_bounds());
        keep(std::move(sensor));
    }

    void add(const ActuatorSensorSpec& what) {
        keep(sim::ActuatorSensor{static_cast<sim::ActuatorSensor::Kind>(what.kind), what.index});
    }

    void add(const DistanceSensorSpec& what) {
        sim::DistanceSensor sensor;
        for (std::size_t k = 0; k < 2; ++k) {
            const auto* name = std::get_if<std::string>(&what.ends[k]);
            sensor.points[k] = name == nullptr ? point(std::get<Vec3>(what.ends[k])) : named(*name);
        }
        keep(std::move(sensor));
    }

    /// The attachment of a marker, or of the centre of mass of an object.
    sim::Attachment named(const std::string& name) {
        for (const sim::Marker& marker : draft_.description.markers) {
            if (marker.name == name) return marker.point;
        }
        for (const sim::FreeObject& object : draft_.description.objects) {
            if (object.name == name) return {{object.nodes.begin(), object.nodes.end()}, {0.25, 0.25, 0.25, 0.25}, {}};
        }
        failed_ = true;
        return {};
    }

    void add(const MotionSensorSpec& what) {
        sim::MotionSensor sensor;
        if (const auto* at = std::get_if<Vec3>(&what.place))
            sensor.frame = frame(*at, what.radius);
        else
            sensor.frame = frame_of_object(std::get<std::string>(what.place));
        const Vec3& x = what.axes[0];
        const Vec3& y = what.axes[1];
        sensor.axes = {x, y, cross(x, y)};
        keep(std::move(sensor));
    }

    /// At its centre of mass; the gradients are those of the affine functions that are 1 at one node and 0 at the
    /// others.
    sim::AttachedFrame frame_of_object(const std::string& name) {
        const auto& objects = draft_.description.objects;
        const auto object = std::ranges::find(objects, name, &sim::FreeObject::name);
        if (object == objects.end()) {
            failed_ = true;
            return {};
        }
        sim::AttachedFrame frame{{object->nodes.begin(), object->nodes.end()}, std::vector<double>(4, 0.25), {}};
        Eigen::Matrix4d places;
        for (Eigen::Index a = 0; a < 4; ++a) {
            const int node = object->nodes[static_cast<std::size_t>(a)];
            places.row(a) << 1,
                linalg::vector(draft_.description.mesh.points[static_cast<std::size_t>(node)]).transpose();
        }
        const Eigen::Matrix4d shapes = places.inverse();
        for (Eigen::Index a = 0; a < 4; ++a) frame.gradients.push_back(vec3(shapes.col(a).tail<3>()));
        return frame;
    }

    ModelDraft& draft_;
    const sim::Attacher& attacher_;
    const SensorSpec* spec_ = nullptr;
    bool failed_ = false;
};

}  // namespace

void add_sensors(ModelDraft& draft, const sim::Attacher& attacher) {
    Builder builder(draft, attacher);
    for (const SensorSpec& spec : draft.robot.sensors) builder.add(spec);
}

}  // namespace pliant::robot
