// Robot files that stand on others.
#include "robot/file/robot_document.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"
#include "robot/description/robot.hpp"
#include "robot/file/robot_file.hpp"

using namespace pliant;
using namespace pliant::robot;
namespace fs = std::filesystem;

namespace {

const std::string leaning = R"(
    name = "bar"
    length_unit = "mm"
    material.soft = { youngs_modulus = "1 MPa" }
    body = [{ name = "bar", material = "soft", geometry = { box = [[0, 0, 0], [40, 10, 10]] } }]
    fixed = [{ name = "clamp", box = [[0, 0, 0], [0, 10, 10]] }]
    marker = [{ name = "tip", point = [40, 5, 5] }]
    cable = [{ name = "up", points = [[0, 5, 9], [40, 5, 9]], target.shortening = "4 mm", range = ["0 mm", "8 mm"] }]
    goal = [{ name = "reach", marker = "tip", times = [1], plane = { point = [0, 0, 8], normal = [0, 0, 1] } }]
    mesh = { size = "5 mm" }
    program = { steps = 7, tolerance = 1e-5 }
)";

/// Three files, each in a folder of its own, of which each stands on the next.
void write_chain(const test::Folder& folder) {
    for (const char* name : {"a", "b", "c"}) fs::create_directories(folder / name);
    REQUIRE(write_file(folder / "c/c.toml", leaning));
    REQUIRE(write_file(folder / "b/b.toml",
                       "robot = \"../c/c.toml\"\nset = [\"mesh.size=6 mm\", \"name=b\"]\n[program]\nsteps = 8\n"
                       "max_iterations = 50\n"));
    REQUIRE(write_file(folder / "a/a.toml",
                       "robot = \"../b/b.toml\"\nset = [\"program.steps=12\", \"name=a\"]\n[program]\nsteps = 9\n"));
}

}  // namespace

TEST_CASE("files stand on each other in a chain, and each changes what the next one says") {
    const test::Folder folder("chain");
    write_chain(folder);
    const auto robot = load_robot(folder / "a/a.toml");
    REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
    CHECK(robot->name == "a");
    CHECK(robot->program.steps == 9);
    CHECK(robot->program.iteration_limit == 50);
    CHECK(robot->program.tolerance == 1e-5);
    CHECK(robot->file == folder / "c/c.toml");
    CHECK(load_robot(folder / "b/b.toml")->program.steps == 8);
    CHECK(load_robot(folder / "a/a.toml", {"program.steps=3"})->program.steps == 3);
    CHECK(files_of(folder / "a/a.toml", {}) ==
          std::vector<fs::path>{folder / "a/a.toml", folder / "b/b.toml", folder / "c/c.toml"});
    const auto texts = base_text(read_file(folder / "a/a.toml").value(), folder / "a/a.toml");
    REQUIRE(texts);
    REQUIRE(*texts);
    CHECK((*texts)->find("mesh.size=6 mm") != std::string::npos);
    CHECK((*texts)->find("name = \"bar\"") != std::string::npos);
    const auto whole = robot_text(read_file(folder / "a/a.toml").value(), folder / "a/a.toml", {}, folder.path());
    REQUIRE(whole);
    REQUIRE(write_file(folder / "whole.toml", *whole));
    CHECK(load_robot(folder / "whole.toml")->program.iteration_limit == 50);
    // Without a folder it is for the working directory.
    const auto for_folder = [&](const fs::path& to) {
        return robot_text("mesh = { file = \"c.toml\" }\n", folder / "c/r.toml", {}, to).value();
    };
    CHECK(for_folder("") == for_folder(fs::current_path()));
    CHECK(for_folder("") != for_folder(folder.path()));
}

TEST_CASE("the files that a robot names have one digest, which changes with any of them") {
    const test::Folder folder("digest");
    const std::string text =
        "obstacle = [{ name = \"wall\", surface = \"wall.stl\" }]\nprogram.file = \"missing.csv\"\n";
    const auto digest = [&](const std::string& of, const std::vector<std::string>& changes = {}) {
        return digest_of_named_files(of, folder / "r.toml", changes).value();
    };
    CHECK(digest("name = \"bar\"\n").empty());
    REQUIRE(write_file(folder / "wall.stl", "solid one"));
    REQUIRE(write_file(folder / "other.stl", "solid two"));
    const std::string one = digest(text);
    CHECK_FALSE(one.empty());
    CHECK(digest(text) == one);
    CHECK(digest(text, {"obstacle.wall.surface=other.stl"}) != one);
    REQUIRE(write_file(folder / "base.toml", text));
    CHECK(digest("robot = \"base.toml\"\n") == one);
    REQUIRE(write_file(folder / "wall.stl", "solid two"));
    CHECK(digest(text) != one);
}

TEST_CASE("the goals of a robot at the end of a chain have the times of its own program") {
    const test::Folder folder("chain");
    write_chain(folder);
    REQUIRE(write_file(folder / "b/b.toml", "robot = \"../c/c.toml\"\n[program]\nduration = \"0.5 s\"\n"));
    REQUIRE(write_file(folder / "a/a.toml", "robot = \"../b/b.toml\"\n"));
    for (const char* file : {"b/b.toml", "a/a.toml"}) {
        const auto robot = load_robot(folder / file);
        CHECK_MESSAGE(robot, (robot ? "" : robot.error().message));
    }
}

TEST_CASE("files that stand on each other in a circle are refused in one line") {
    const test::Folder folder("chain");
    write_chain(folder);
    REQUIRE(write_file(folder / "c/c.toml", "robot = \"../a/a.toml\"\n"));
    const auto robot = load_robot(folder / "a/a.toml");
    REQUIRE_FALSE(robot);
    CHECK(robot.error().message ==
          (folder / "c/c.toml").string() + ":1: robot: stands on itself: a.toml -> b.toml -> c.toml -> a.toml");
    CHECK(files_of(folder / "a/a.toml", {}).size() == 3);
    CHECK(base_text(read_file(folder / "a/a.toml").value(), folder / "a/a.toml"));
    REQUIRE(write_file(folder / "b/b.toml", "robot = \"b.toml\"\n"));
    CHECK(load_robot(folder / "a/a.toml").error().message ==
          (folder / "b/b.toml").string() + ":1: robot: stands on itself: a.toml -> b.toml -> b.toml");
}

TEST_CASE("a mistake in the middle of a chain is told of the file that has it") {
    const test::Folder folder("chain");
    write_chain(folder);
    REQUIRE(write_file(folder / "b/b.toml", "robot = \"../c/c.toml\"\nname = \"b\"\n"));
    CHECK(load_robot(folder / "a/a.toml").error().message.starts_with((folder / "b/b.toml").string() + ":2: name: "));
    REQUIRE(write_file(folder / "b/b.toml", "robot = \"../c/none.toml\"\n"));
    CHECK(load_robot(folder / "a/a.toml").error().message.starts_with((folder / "c/none.toml").string() + ": "));
}

TEST_CASE("a target that keys of the program say is idle, and a robot with another one has a note") {
    const std::string text = R"(name = "bar"
length_unit = "mm"
material.soft = { youngs_modulus = "1 MPa", poisson_ratio = 0.4 }
body = [{ name = "bar", material = "soft", geometry = { box = [[0, 0, 0], [40, 10, 10]] } }]
fixed = [{ name = "clamp", box = [[0, 0, 0], [0, 10, 10]] }]
cable = [{ name = "left.1", points = [[0, 2, 5], [40, 2, 5]], target = { tension = "1 N", offset = "0.1 N" } },
         { name = "right", points = [[0, 8, 5], [40, 8, 5]], target = { length_ratio = 0.9 } }]
program.key = [{ time = "1 s", "left.1" = "2 N" }, { time = "2 s", "left.1" = "1 N" }]
)";
    const std::string idle =
        " changes nothing, since keys of the program drive cable \"left.1\" and say its targets; set "
        "program.key[1].\"left.1\" instead";
    const auto document = config::parse(text, "bar.toml");
    REQUIRE(document);
    for (const char* path : {"cable.\"left.1\".target.tension", "cable[0].target.tension"})
        CHECK(why_idle(*document, path) == path + idle);
    for (const char* path : {"cable[0].target.offset", "cable[0].friction", "cable[1].target.length_ratio",
                             "program.key[1].\"left.1\"", "cable[2].target.tension"})
        CHECK_MESSAGE(why_idle(*document, path).empty(), path);
    CHECK(parse_robot(text, "bar.toml")->notes.empty());
    const auto robot = parse_robot(text, "bar.toml", {"cable[0].target.tension=3 N", "cable[0].friction=0.1"});
    REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
    CHECK(robot->notes == std::vector<std::string>{"cable[0].target.tension" + idle});
}
