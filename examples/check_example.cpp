// Runs an example and compares it with the numbers beside it: check_example FOLDER [--update]
//
// FOLDER/expected.json lists runs: a robot file, changes as of --set, and what the summary must hold, by JSON pointer.
// "/last" stands for the last step, "/count" for the number of steps. Numbers may be off by `tolerance` (0.5 % where
// the file says nothing): of the value, and for markers of their way from rest. --update writes what was measured.
#include <fmt/core.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "presentation/report/summary.hpp"
#include "robot/bodies/build.hpp"
#include "robot/file/robot_file.hpp"
#include "simulation/run/simulate.hpp"
#include "simulation/scene/build_model.hpp"

using namespace pliant;
using Json = nlohmann::ordered_json;

namespace {

/// The summary of a run as `pliant simulate --json` prints it, and the shortcuts.
Result<Json> simulate(const std::filesystem::path& file, const std::vector<std::string>& assignments) {
    const Result<robot::Robot> robot = robot::load_robot(file, assignments);
    if (!robot) return tl::unexpected(robot.error());
    Progress silent;
    Result<mesh::TetMesh> mesh = robot::build_mesh(*robot, silent);
    if (!mesh) return tl::unexpected(mesh.error());
    const Result<sim::Model> model = robot::build_model(*robot, std::move(*mesh));
    if (!model) return tl::unexpected(model.error());
    const sim::Trajectory result = sim::run(*model, robot->program, silent);
    Json summary = Json::parse(report::summary_json({.robot = robot->name, .mesh = model->mesh(), .result = result}));
    summary["count"] = summary["steps"].size();
    summary["last"] = summary["steps"].empty() ? summary["rest"] : summary["steps"].back();
    return summary;
}

std::vector<double> numbers(const Json& value) {
    return value.is_array() ? value.get<std::vector<double>>() : std::vector<double>{value.get<double>()};
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(sum);
}

/// What a deviation is measured by: the way from rest for markers, else the value itself.
double scale(const Json& summary, const std::string& pointer, const std::vector<double>& wanted) {
    const std::size_t marker = pointer.find("/markers/");
    if (marker == std::string::npos) return distance(wanted, std::vector<double>(wanted.size(), 0.0));
    return distance(wanted, numbers(summary.at(Json::json_pointer("/rest" + pointer.substr(marker)))));
}

/// Six digits: more would be noise in the file.
Json rounded(const Json& value) {
    if (value.is_array()) {
        Json list = Json::array();
        for (const Json& v : value) list.push_back(rounded(v));
        return list;
    }
    return value.is_number_float() ? Json(std::stod(fmt::format("{:.6g}", value.get<double>()))) : value;
}

/// True where the summary holds what is expected at the pointer.
bool agrees(const Json& summary, const std::string& pointer, const Json& expected, double tolerance) {
    const Json::json_pointer place(pointer);
    if (!summary.contains(place)) {
        fmt::print("  {}: is not in the summary\n", pointer);
        return false;
    }
    const Json& found = summary.at(place);
    bool good = found == expected;
    if (!good && found.size() == expected.size() && (found.is_number() || found.is_array()) &&
        (expected.is_number() || expected.is_array())) {
        const auto wanted = numbers(expected);
        good = distance(numbers(found), wanted) <= tolerance * scale(summary, pointer, wanted);
    }
    fmt::print("  {}: {}{}\n", pointer, rounded(found).dump(), good ? "" : ", expected " + expected.dump());
    return good;
}

bool check_run(const std::filesystem::path& folder, Json& run, bool update) {
    const auto assignments = run.value("set", std::vector<std::string>{});
    const std::string robot = run.at("robot").get<std::string>();
    fmt::print("{}", robot);
    for (const std::string& assignment : assignments) fmt::print(" --set {}", assignment);
    fmt::print("\n");
    const Result<Json> summary = simulate(folder / robot, assignments);
    if (!summary) {
        fmt::print("  {}\n", summary.error().message);
        return false;
    }
    bool good = summary->at("converged").get<bool>();
    if (!good) fmt::print("  {}\n", summary->at("message").get<std::string>());
    for (auto& [pointer, expected] : run.at("expect").items()) {
        if (update && summary->contains(Json::json_pointer(pointer)))
            expected = rounded(summary->at(Json::json_pointer(pointer)));
        good = agrees(*summary, pointer, expected, run.value("tolerance", 5e-3)) && good;
    }
    return good;
}

/// One line per expected value: a file that people read and compare.
std::string to_text(const Json& expected) {
    std::string text = "{\n  \"runs\": [";
    for (std::size_t r = 0; r < expected.at("runs").size(); ++r) {
        text += r == 0 ? "\n    {" : ",\n    {";
        std::string separator = "\n";
        for (const auto& [key, value] : expected.at("runs")[r].items()) {
            text += separator + "      " + Json(key).dump() + ": ";
            separator = ",\n";
            if (key != "expect") {
                text += value.dump();
                continue;
            }
            std::string comma = "{\n";
            for (const auto& [pointer, wanted] : value.items()) {
                text += comma + "        " + Json(pointer).dump() + ": " + wanted.dump();
                comma = ",\n";
            }
            text += "\n      }";
        }
        text += "\n    }";
    }
    return text + "\n  ]\n}\n";
}

int check(const std::filesystem::path& folder, bool update) {
    const std::filesystem::path file = folder / "expected.json";
    Json expected = Json::parse(std::ifstream(file));
    bool good = !expected.at("runs").empty();
    for (Json& run : expected.at("runs")) good = check_run(folder, run, update) && good;
    if (update) std::ofstream(file) << to_text(expected);
    fmt::print("{}\n", good ? "as expected" : "NOT as expected");
    return good ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    const bool update = argc == 3 && std::string_view(argv[2]) == "--update";
    if (argc != 2 && !update) {
        fmt::print(stderr, "usage: check_example FOLDER [--update]\n");
        return 2;
    }
    try {
        return check(argv[1], update);
    } catch (const Json::exception& e) {
        fmt::print(stderr, "{}: {}\n", argv[1], e.what());
        return 2;
    }
}
