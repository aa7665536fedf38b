// Bars on small meshes, and synthetic measurements on them.
#pragma once

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "robot/bodies/build.hpp"
#include "robot/file/robot_file.hpp"
#include "simulation/identify/identify.hpp"
#include "simulation/identify/trial.hpp"
#include "simulation/peers/reference_problems.hpp"

namespace pliant::sim::identify::testing {

/// A bar of 60 x 10 x 10 mm, clamped at x = 0, of a firm half and a soft one.
inline const std::string bar_text = R"(
    name = "bar"
    length_unit = "mm"
    material.firm = { youngs_modulus = "2 MPa", poisson_ratio = 0.4, density = "1200 kg/m^3" }
    material.soft = { youngs_modulus = "0.7 MPa", poisson_ratio = 0.42, density = "1000 kg/m^3" }
    mesh = { file = "memory:", order = 1 }
    body = [{ name = "root", material = "firm", region = "root" }, { name = "end", material = "soft", region = "end" }]
    fixed = [{ name = "clamp", box = [[0, 0, 0], [0, 10, 10]] }]
    marker = [{ name = "middle", point = [30, 5, 10] }, { name = "tip", point = [60, 5, 5] },
              { name = "corner", point = [60, 10, 10] }]
)";

/// The same bar with a hollow along its middle, which is a chamber.
inline mesh::TetMesh bar_mesh(bool hollow) {
    const auto inside = [](double v, double low, double high) { return v > low && v < high; };
    const int across = hollow ? 3 : 2;
    mesh::TetMesh mesh = sim::reference::kuhn_box({0.06, 0.01, 0.01}, 8, across, across, [&](Vec3 c) {
        const double third = 0.01 / 3;
        if (hollow && inside(c.x, 0.0075, 0.0525) && inside(c.y, third, 2 * third) && inside(c.z, third, 2 * third))
            return 2;
        return c.x < 0.03 ? 0 : 1;
    });
    mesh.region_names = {"root", "end"};
    if (hollow) mesh.region_names.emplace_back("air");
    return mesh;
}

/// The text of a robot file for that mesh.
struct Bar {
    std::string text;
    Source source;

    explicit Bar(const std::string& more, const std::vector<std::string>& set = {})
        : text(bar_text + more), source(reader(text, set), mesh_of(text)) {}
    /// A robot other than that bar, on another mesh.
    Bar(const std::string& whole, mesh::TetMesh mesh)
        : text(whole), source(reader(text, {}), taken(text, std::move(mesh))) {}

    [[nodiscard]] robot::Robot robot() const {
        auto robot = source.robot();
        REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
        return std::move(*robot);
    }
    [[nodiscard]] std::vector<Unknown> unknowns(const std::vector<std::string>& texts) const {
        std::vector<Unknown> all;
        for (const std::string& one : texts) {
            auto unknown = find_unknown(robot(), one);
            REQUIRE_MESSAGE(unknown, (unknown ? "" : unknown.error().message));
            all.push_back(std::move(*unknown));
        }
        return all;
    }
    [[nodiscard]] std::unique_ptr<Variant> variant(const std::vector<Unknown>& unknowns = {},
                                                   const std::vector<double>& values = {}) const {
        auto variant = source.with(unknowns, values);
        REQUIRE_MESSAGE(variant, (variant ? "" : variant.error().message));
        return std::move(*variant);
    }
    [[nodiscard]] std::vector<Channel> channels(const std::vector<std::string>& columns) const {
        std::vector<Channel> all;
        for (const std::string& column : columns) {
            auto channel = find_channel(variant()->model.description(), column);
            REQUIRE_MESSAGE(channel, column);
            all.push_back(std::move(*channel));
        }
        return all;
    }
    [[nodiscard]] Measurements read(const std::string& csv, JudgeOn judge = JudgeOn::nothing) const {
        auto read = parse_measurements(csv, "m.csv", variant()->model.description(), robot().program, judge);
        REQUIRE_MESSAGE(read, (read ? "" : read.error().message));
        return std::move(*read);
    }

private:
    static ReadRobot reader(const std::string& text, const std::vector<std::string>& set) {
        return [text, set](const std::vector<std::string>& more) {
            std::vector<std::string> all = set;
            all.insert(all.end(), more.begin(), more.end());
            return robot::parse_robot(text, "bar.toml", all);
        };
    }
    static robot::Robot read_text(const std::string& text) {
        auto robot = robot::parse_robot(text, "bar.toml");
        REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
        return std::move(*robot);
    }
    static mesh::TetMesh mesh_of(const std::string& text) {
        return taken(text, bar_mesh(!read_text(text).chambers.empty()));
    }
    static mesh::TetMesh taken(const std::string& text, mesh::TetMesh given) {
        auto mesh = robot::take_mesh(read_text(text), std::move(given));
        REQUIRE_MESSAGE(mesh, (mesh ? "" : mesh.error().message));
        return std::move(*mesh);
    }
};

inline std::unique_ptr<Trial> solve(const Bar& bar, const std::vector<Unknown>& unknowns,
                                    const std::vector<double>& values, const std::vector<Channel>& channels,
                                    const std::vector<double>& times) {
    Progress silent;
    auto trial = Trial::solve(bar.variant(unknowns, values), channels, times, silent);
    REQUIRE_MESSAGE(trial, (trial ? "" : trial.error().message));
    return std::move(*trial);
}

/// Synthetic measurements with these values, as a table; `disturb(k)` is added to the k-th value.
template <class Disturb>
std::string table_of(const Bar& bar, const std::vector<Unknown>& unknowns, const std::vector<double>& values,
                     const std::vector<std::string>& columns, const std::vector<double>& times, Disturb disturb) {
    const auto trial = solve(bar, unknowns, values, bar.channels(columns), times);
    std::string text = "time";
    for (const std::string& column : columns) text += "," + column;
    int count = 0;
    for (std::size_t t = 0; t < times.size(); ++t) {
        text += fmt::format("\n{:.15g}", times[t]);
        for (std::size_t c = 0; c < columns.size(); ++c)
            text +=
                fmt::format(",{:.15g}", trial->values()(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(c)) +
                                            disturb(count++));
    }
    return text + "\n";
}

inline double undisturbed(int) {
    return 0;
}

inline Identification find(const Bar& bar, const std::vector<Unknown>& unknowns, const Measurements& measurements) {
    Progress silent;
    auto result = identify(bar.source, unknowns, measurements, silent);
    REQUIRE_MESSAGE(result, (result ? "" : result.error().message));
    return std::move(*result);
}

}  // namespace pliant::sim::identify::testing
