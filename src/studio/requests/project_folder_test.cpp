// Paths cannot lead out of the project folder.
#include "studio/requests/project_folder.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>

#include "base/core/test_folder.hpp"

using namespace pliant::studio;
namespace fs = std::filesystem;

namespace {

/// A project beside a folder that it must not access.
struct Place {
    pliant::test::Folder folder{"project"};
    fs::path base = folder.path();
    fs::path project = base / "project";
    Place() {
        fs::create_directories(project / "parts" / "deep" / "deeper");
        fs::create_directories(base / "project_secret");
        for (const char* name :
             {"project/a.toml", "project/b.txt", "project/.hidden.toml", "project/parts/c.zip",
              "project/parts/deep/d.toml", "project/parts/deep/deeper/e.toml", "project_secret/s.toml"})
            std::ofstream(base / name) << "x";
        fs::create_directory_symlink(base / "project_secret", project / "way_out");
        fs::create_symlink(base / "project_secret" / "s.toml", project / "link.toml");
    }
};

}  // namespace

TEST_CASE("paths within the folder are found, all others refused") {
    const Place place;
    const auto folder = ProjectFolder::open(place.project);
    REQUIRE(folder);
    for (const char* good : {"a.toml", "parts/c.zip", "new.toml", "parts/new.toml", "no/such/folder.toml"}) {
        const auto path = folder->resolve(good);
        CHECK_MESSAGE(path, good);
        if (path) CHECK(*path == fs::canonical(place.project) / good);
    }
    for (const char* bad : {"", "/etc/passwd", "..", "../project_secret/s.toml", "parts/../../project_secret/s.toml",
                            "./a.toml", "parts/./c.zip", "way_out/s.toml", "link.toml", "parts//c.zip/", "a\\..\\b",
                            "a\nb.toml", "\x7f", "parts/", "way_out/new.toml", "../project_secret"})
        CHECK_MESSAGE(!folder->resolve(bad), bad);
    CHECK_FALSE(folder->resolve(std::string_view("a.toml\0/../../x", 15)));
    CHECK_FALSE(folder->resolve(std::string(5000, 'a')));
}

TEST_CASE("a folder holds the files in it, not those in a folder whose name begins alike") {
    const Place place;
    const auto folder = ProjectFolder::open(place.project);
    REQUIRE(folder);
    CHECK(folder->holds(place.project / "parts" / "c.zip"));
    CHECK(folder->holds(place.project / "parts" / ".." / "a.toml"));
    CHECK_FALSE(folder->holds(place.base / "project_secret" / "s.toml"));
    CHECK_FALSE(folder->holds(place.project / "way_out" / "s.toml"));
    CHECK_FALSE(folder->holds(place.project / ".." / "project_secret" / "s.toml"));
}

TEST_CASE("robots and jobs are listed two levels deep, and links are not followed") {
    const Place place;
    const auto folder = ProjectFolder::open(place.project);
    REQUIRE(folder);
    CHECK(folder->files() == std::vector<std::string>{"a.toml", "parts/c.zip", "parts/deep/d.toml"});
}

TEST_CASE("a folder that does not exist is refused") {
    CHECK_FALSE(ProjectFolder::open("/no/such/folder"));
}

TEST_CASE("texts of a document that lead outside the folder are found under any key") {
    const Place place;
    const auto folder = ProjectFolder::open(place.project);
    REQUIRE(folder);
    const std::string toml = R"(name = "a / b"
pitch = "= 84 / gaps"
size = "2.5 mm"
mesh.file = "../project_secret/s.toml"
body = [{ geometry = { union = [{ step = "/etc/passwd" }, { box = [1] }] } }, { geometry = "parts/c.zip" }]
surface = "link.toml"
up = "..")";
    CHECK(folder->texts_leading_outside(toml, place.project / "a.toml") ==
          std::vector<std::string>{"../project_secret/s.toml", "/etc/passwd", "link.toml", ".."});
    const std::vector<std::string> known = {"..", "/etc/passwd", "link.toml"};
    const auto unknown = folder->check_texts(toml, place.project / "a.toml", known);
    REQUIRE_FALSE(unknown);
    CHECK(unknown.error().message.find("\"../project_secret/s.toml\" lies outside of the project folder") == 0);
    CHECK(folder->check_texts("up = \"..\"", place.project / "a.toml", known));
    CHECK_FALSE(folder->check_texts("up = \"..\"", place.project / "a.toml"));
    CHECK(folder->texts_leading_outside("x = \"" + std::string(5000, 'a') + "\"", place.project / "a.toml").empty());
    CHECK(folder->texts_leading_outside("not toml", place.project / "a.toml").empty());
}

TEST_CASE("what a robot changes of the one that it is based on cannot lead outside either") {
    const Place place;
    const auto folder = ProjectFolder::open(place.project);
    REQUIRE(folder);
    std::ofstream(place.project / "parts" / "base.toml") << "[body]\ngeometry = \"b.stl\"\n";
    std::ofstream(place.project / "parts" / "bad.toml") << "[body]\ngeometry = \"../../project_secret/s.toml\"\n";
    std::ofstream(place.project / "parts" / "second.toml") << "robot = \"bad.toml\"\n";
    std::ofstream(place.base / "own.toml") << "[body]\ngeometry = \"own.stl\"\n";
    const fs::path file = place.project / "a.toml";
    const auto based = [](const std::string& robot, const std::string& set = "") {
        return "robot = \"" + robot + "\"\nset = [" + set + "]\n";
    };
    const auto why = [&](const std::string& toml) {
        const auto status = folder->check_texts(toml, file);
        return status ? "" : status.error().message.substr(0, status.error().message.find(" lies"));
    };
    CHECK(why(based("parts/base.toml")) == "");
    CHECK(why(based("parts/base.toml", R"('body.geometry="c.stl"', 'program.steps=3', 'mesh.size=2 mm')")) == "");
    CHECK(why(based("parts/base.toml", R"('body.geometry="../c.stl"')")) == "");  // beside the base: in the folder
    CHECK(why(based("parts/base.toml", R"('body.geometry="/etc/passwd"')")) == "\"/etc/passwd\"");
    CHECK(why(based("parts/base.toml", R"('body.geometry=/etc/passwd')")) == "\"/etc/passwd\"");
    CHECK(why(based("parts/base.toml", R"('body={ geometry = [{ step = "/etc/passwd" }] }')")) == "\"/etc/passwd\"");
    CHECK(why(based("parts/base.toml", R"('body.geometry="../../own.stl"')")) == "\"parts/../../own.stl\"");
    CHECK(why(based("none.toml", R"('body.geometry="/etc/passwd"')")) == "\"/etc/passwd\"");
    CHECK(why(based("parts/bad.toml")) == "\"parts/../../project_secret/s.toml\"");
    CHECK(why(based("parts/second.toml")) == "\"parts/../../project_secret/s.toml\"");
    CHECK(why("robot = \"parts/base.toml\"\nprogram.file = \"../../own.stl\"\n") == "\"parts/../../own.stl\"");
    CHECK(why(based("../own.toml")) == "\"../own.toml\"");
    CHECK(why("robot = \"a.toml\"\n") == "");
    // What stands on a file that stands on another one is relative to the folder of the last of them.
    std::ofstream(place.project / "last.toml") << "[body]\ngeometry = \"b.stl\"\n";
    std::ofstream(place.project / "parts" / "up.toml") << "robot = \"../last.toml\"\n";
    CHECK(why(based("parts/up.toml", R"('body.geometry="b.stl"')")) == "");
    CHECK(why(based("parts/up.toml", R"('body.geometry="../own.stl"')")) == "\"parts/../../own.stl\"");
    std::ofstream(place.project / "0.toml") << "robot = \"parts/bad.toml\"\n";
    for (int k = 1; k <= 30; ++k)
        std::ofstream(place.project / (std::to_string(k) + ".toml"))
            << "robot = \"" << std::to_string(k - 1) << ".toml\"\n";
    CHECK(why(based("30.toml")) == "\"parts/../../project_secret/s.toml\"");
    // What the user's own file is based on is known, with the files that it names.
    const std::vector<std::string> own = folder->texts_leading_outside(based("../own.toml"), file);
    CHECK(own == std::vector<std::string>{"../own.toml", "../own.stl"});
    CHECK(folder->check_texts(based("../own.toml"), file, own));
    CHECK_FALSE(folder->check_texts(based("../own.toml", R"('body.geometry="other.stl"')"), file, own));
}

TEST_CASE("a fingerprint changes with the geometry of a robot that another one is based on") {
    const Place place;
    const auto folder = ProjectFolder::open(place.project);
    REQUIRE(folder);
    const fs::path file = place.project / "a.toml";
    std::ofstream(place.project / "parts" / "base.toml") << "[body]\ngeometry = \"b.stl\"\n";
    std::ofstream(place.project / "parts" / "b.stl") << "one";
    const std::string toml = "robot = \"parts/base.toml\"\nset = ['body.geometry=\"c.stl\"']\n";
    const std::string first = folder->stamps_of(toml, file);
    std::ofstream(place.project / "parts" / "b.stl") << "another";
    const std::string second = folder->stamps_of(toml, file);
    CHECK(second != first);
    std::ofstream(place.project / "parts" / "c.stl") << "new";
    const std::string third = folder->stamps_of(toml, file);
    CHECK(third != second);
    std::ofstream(place.project / "parts" / "base.toml", std::ios::app) << "# longer\n";
    CHECK(folder->stamps_of(toml, file) != third);
    CHECK(folder->stamps_of("name = \"b.stl\"", file).empty());
}
