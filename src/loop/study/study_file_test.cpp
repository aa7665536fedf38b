#include "loop/study/study_file.hpp"

#include <doctest/doctest.h>

#include <set>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"

using namespace pliant;
using namespace pliant::study;

namespace {

const std::vector<std::string> commands{"simulate", "inverse", "slice", "plan"};

Result<Plan> parsed(const std::string& text, const std::filesystem::path& file = "s.toml") {
    return parse_study(text, file, {commands, "1.0"});
}

Plan plan_of(const std::string& text) {
    auto plan = parsed(text);
    REQUIRE_MESSAGE(plan, (plan ? "" : plan.error().message));
    return *plan;
}

std::string mistake(const std::string& text) {
    const auto plan = parsed(text);
    return plan ? "" : plan.error().message;
}

const std::string head = "command = [\"simulate\", \"finger.toml\"]\n";
const std::string modulus =
    "key.modulus = { set = \"material.soft.youngs_modulus\", range = [\"5 MPa\", \"20 MPa\"], levels = 4 }\n";
const std::string pull = "key.pull = { set = \"cable.flexor.target.length_ratio\", values = [0.95, 0.9] }\n";
const std::string tension = "result.tension = \"cables.flexor.tension_N\"\n";

}  // namespace

TEST_CASE("a grid has every combination, the last key fastest, and sets the keys on the command line") {
    const Plan plan = plan_of(head + "plan = \"grid\"\n" + modulus + pull + tension);
    CHECK(plan.study == "s");
    CHECK(plan.rows.size() == 8);
    CHECK(plan.rows[0] == std::vector<std::string>{"5", "0.95"});
    CHECK(plan.rows[1] == std::vector<std::string>{"5", "0.9"});
    CHECK(plan.rows[7] == std::vector<std::string>{"20", "0.9"});
    CHECK(row_words(plan, 2, "/o") == std::vector<std::string>{"simulate", "finger.toml", "--set",
                                                               "material.soft.youngs_modulus=10 MPa", "--set",
                                                               "cable.flexor.target.length_ratio=0.95", "--json"});
}

TEST_CASE("keys may also be options and words of the command") {
    const Plan plan = plan_of(
        "command = [\"slice\", \"{part}\", \"--printer\", \"tower\", \"-o\", \"{row}/job.zip\"]\nplan = \"grid\"\n"
        "key.layer = { option = \"--layer\", values = [\"50 um\", \"100 um\"] }\n"
        "key.part = { values = [\"a.stl\", \"b.stl\"] }\nresult.layers = \"layers\"\n");
    CHECK(wants_row_folder(plan));
    CHECK(row_words(plan, 1, "/o/1") == std::vector<std::string>{"slice", "b.stl", "--printer", "tower", "-o",
                                                                 "/o/1/job.zip", "--layer=50 um", "--json"});
}

TEST_CASE("the command gets listed values as they are written") {
    const auto words = [](const std::string& values) {
        return row_words(plan_of("command = [\"simulate\", \"robot_{n}.toml\"]\nplan = \"grid\"\nkey.n = { values = " +
                                 values + " }\n" + tension),
                         0, "/o")[1];
    };
    CHECK(words("[\"001\", \"002\"]") == "robot_001.toml");
    CHECK(words("[\"10mm\", \"20mm\"]") == "robot_10mm.toml");
    CHECK(words("[\"10 mm\", \"20 mm\"]") == "robot_10 mm.toml");
    CHECK(words("[\"30A\", \"50A\"]") == "robot_30A.toml");
}

TEST_CASE("samples cover the ranges; a sensitivity plan has n (k + 2) rows") {
    const std::string keys = modulus + "key.pull = { set = \"p\", range = [0.8, 0.9] }\n" + tension;
    for (const std::string design : {"sobol", "latin-hypercube", "sensitivity"}) {
        const Plan plan = plan_of(head + "plan = \"" + design + "\"\nsamples = 16\nseed = 3\n" + keys);
        CHECK(plan.rows.size() == (design == "sensitivity" ? 64 : 16));
        std::set<std::string> different;
        for (const auto& row : plan.rows) {
            const double number = std::stod(row[0]);
            CHECK((number >= 5 && number <= 20));
            different.insert(row[0]);
        }
        CHECK(different.size() >= 16);
    }
}

TEST_CASE("a plan is read back from its JSON unchanged") {
    const Plan plan =
        plan_of(head + "plan = \"sensitivity\"\nsamples = 4\nrow_limit = \"10 min\"\n" + modulus + tension +
                "[slurm]\npartition = \"short\"\ntime = \"00:10:00\"\noptions = [\"--qos=low\"]\nrows_per_task = 2\n");
    const auto back = parse_plan(plan_json(plan), "plan.json");
    REQUIRE(back);
    CHECK(plan_json(*back) == plan_json(plan));
    CHECK(back->row_limit_s == 600);
    CHECK(back->rows_per_chunk == 2);
    CHECK(back->chunk_count() == 6);
    CHECK(back->slurm.options == std::vector<std::string>{"--qos=low"});
    CHECK_FALSE(parse_plan("{}", "plan.json"));
    CHECK_FALSE(parse_plan(plan_json(plan).substr(0, 300), "plan.json"));
}

TEST_CASE("rows per chunk: at most 1000 chunks for an array, hundreds of rows each in large studies") {
    CHECK(usual_rows_per_chunk(1) == 1);
    CHECK(usual_rows_per_chunk(64) == 1);
    CHECK(usual_rows_per_chunk(10000) == 157);
    CHECK(usual_rows_per_chunk(100000) == 200);
    CHECK(usual_rows_per_chunk(1000000) == 1000);
}

TEST_CASE("a table of rows: its columns are keys of the robot file, or keys of the study by name") {
    const pliant::test::Folder folder("study");
    const auto file = folder / "s.toml";
    const std::string text = head + "plan = \"table\"\ntable = \"designs.csv\"\n" + tension;
    REQUIRE(write_file(folder / "designs.csv", "material.soft.youngs_modulus (MPa),mesh.order\n5,1\n20,2\n"));
    const auto plan = parsed(text, file);
    REQUIRE_MESSAGE(plan, (plan ? "" : plan.error().message));
    CHECK(row_words(*plan, 1, "") == std::vector<std::string>{"simulate", "finger.toml", "--set",
                                                              "material.soft.youngs_modulus=20 MPa", "--set",
                                                              "mesh.order=2", "--json"});
    const auto named = parsed(text + "key.modulus = { set = \"material.soft.youngs_modulus\" }\n", file);
    REQUIRE_FALSE(named);
    CHECK(named.error().message.ends_with("designs.csv:1: has no column \"modulus\", which is a key of the study"));
    REQUIRE(write_file(folder / "designs.csv", "cable[0].target.length_ratio,object[0].mass ( g ),cable[1]\n5,1,2\n"));
    const auto indexed = parsed(text, file);
    REQUIRE_MESSAGE(indexed, (indexed ? "" : indexed.error().message));
    CHECK(row_words(*indexed, 0, "") ==
          std::vector<std::string>{"simulate", "finger.toml", "--set", "cable[0].target.length_ratio=5", "--set",
                                   "object[0].mass=1 g", "--set", "cable[1]=2", "--json"});
    REQUIRE(write_file(folder / "designs.csv", "a,b\n1,2\n3,\n"));
    const auto hole = parsed(text, file);
    REQUIRE_FALSE(hole);
    CHECK(hole.error().message.ends_with("designs.csv:3: has no value of \"b\"; every row needs one for each column"));
    REQUIRE(write_file(folder / "designs.csv", "a (MPa)\nsoft\n"));
    const auto word = parsed(text, file);
    REQUIRE_FALSE(word);
    CHECK(word.error().message.ends_with("designs.csv:2: \"soft\" is not a number, but the column \"a\" has a unit"));
}

TEST_CASE("a mistake in a study file gives one line: where, and what would be right") {
    const std::string rest = "plan = \"grid\"\n" + modulus + tension;
    CHECK(mistake(rest) == "s.toml:1: command: is missing; write its words, as in [\"simulate\", \"finger.toml\"]");
    CHECK(mistake("comand = [\"simulate\"]\n" + head + rest) ==
          "s.toml:1: comand: unknown key; did you mean \"command\"?");
    CHECK(mistake("command = [\"simualte\"]\n" + rest) ==
          "s.toml:1: command: a study cannot run \"simualte\", did you mean \"simulate\"?; it runs simulate, inverse, "
          "slice and plan");
    CHECK(mistake(head + "plan = \"sobel\"\nsamples = 4\n" + modulus + tension).find("did you mean \"sobol\"?") !=
          std::string::npos);
    CHECK(mistake(head + "plan = \"grid\"\n" + tension).find("nothing varies; write [key.NAME]") != std::string::npos);
    CHECK(mistake(head + "plan = \"grid\"\n" + modulus).find("result") != std::string::npos);
    CHECK(mistake(head + "plan = \"sobol\"\n" + modulus + tension).find("samples") != std::string::npos);
    CHECK(mistake(head + "plan = \"grid\"\nsamples = 4\n" + modulus + tension).find("samples: goes with sobol, ") !=
          std::string::npos);
    CHECK(mistake(head + "plan = \"grid\"\nkey.a = { set = \"a\", range = [0, 1] }\n" + tension)
              .find("a grid needs its levels") != std::string::npos);
    CHECK(mistake(head + "plan = \"grid\"\nkey.a = { range = [0, 1], levels = 2 }\n" + tension)
              .find("says nothing to the command") != std::string::npos);
    CHECK(mistake(head + "plan = \"grid\"\n" + modulus + "result.tension = \"cables..tension_N\"\n")
              .find("a key is expected at letter 8") != std::string::npos);
}

TEST_CASE("an output that all rows would write is refused, one of each row is not") {
    const std::string rest = "plan = \"grid\"\n" + modulus + tension;
    const std::string refused =
        "s.toml:1: command: all rows would write \"x\", one over the other; {row} in it stands for "
        "a folder of the row's own, as in \"";
    const auto command = [](const std::string& words) {
        return "command = [\"simulate\", \"finger.toml\", " + words + "]\n";
    };
    CHECK(mistake(command("\"-o\", \"x\"") + rest) == refused + "-o\", \"{row}/out\"");
    CHECK(mistake(command("\"--output\", \"x\"") + rest) == refused + "--output\", \"{row}/out\"");
    CHECK(mistake(command("\"--output=x\"") + rest) == refused + "--output\", \"{row}/out\"");
    CHECK(mistake(command("\"-ox\"") + rest) == refused + "-o\", \"{row}/out\"");
    CHECK(mistake(command("\"-o{row}/x\"") + rest) == "");
    CHECK(mistake(command("\"-o\", \"{row}/x\"") + rest) == "");
    CHECK(mistake(command("\"-o\", \"x_{E}\"") + "plan = \"grid\"\nkey.E = { values = [1, 2] }\n" + tension) == "");
}

TEST_CASE("names that would be one column, and keys that set the same thing, are refused with their line") {
    CHECK(mistake(head + "plan = \"grid\"\n" + modulus + "result.modulus = \"cables.flexor.tension_N\"\n") ==
          "s.toml:4: result.modulus: is the name of key.modulus too; in results.csv every column needs a name of its "
          "own");
    CHECK(mistake(head + "plan = \"sobol\"\nsamples = 4\n" + modulus + tension +
                  "key.stiff = { set = \"material.soft.youngs_modulus\", range = [\"1 MPa\", \"2 MPa\"] }\n") ==
          "s.toml:6: key.stiff: sets \"material.soft.youngs_modulus\", as key.modulus does; only one of them may");
    const pliant::test::Folder folder("study");
    REQUIRE(write_file(folder / "designs.csv", "status,mesh.order\n5,1\n"));
    const auto table = parsed(head + "plan = \"table\"\ntable = \"designs.csv\"\n" + tension, folder / "s.toml");
    REQUIRE_FALSE(table);
    CHECK(
        table.error().message.ends_with("s.toml:3: table: column \"status\" is the name of a column that every "
                                        "results.csv has; every column needs a name of its own"));
}

TEST_CASE("a grid that is too big is refused before it is built") {
    std::string text = head + "plan = \"grid\"\n" + tension;
    for (int k = 0; k < 10; ++k)
        text +=
            "key.k" + std::to_string(k) + " = { set = \"a" + std::to_string(k) + "\", range = [0, 1], levels = 100 }\n";
    CHECK(mistake(text) ==
          "s.toml:2: plan: the grid has over 1000000 rows; take fewer levels, or plan = \"sobol\" with samples");
}

TEST_CASE("a change of text, table, robot file or version gives another fingerprint") {
    const pliant::test::Folder folder("study");
    const auto file = folder / "s.toml";
    const std::string text = head + "plan = \"grid\"\n" + modulus + tension;
    REQUIRE(write_file(folder / "finger.toml", "name = \"a\"\n"));
    const auto fingerprint = [&](const std::string& study, const std::string& version) {
        const auto plan = parse_study(study, file, {commands, version});
        REQUIRE(plan);
        return plan->fingerprint;
    };
    const std::string first = fingerprint(text, "1.0");
    CHECK(fingerprint(text, "1.0") == first);
    CHECK(fingerprint(text + "\n", "1.0") != first);
    CHECK(fingerprint(text, "1.1") != first);
    REQUIRE(write_file(folder / "finger.toml", "name = \"b\"\n"));
    CHECK(fingerprint(text, "1.0") != first);
}

TEST_CASE("a change of a robot that a file stands on, or of a file that an option names, gives another fingerprint") {
    const pliant::test::Folder folder("study");
    REQUIRE(write_file(folder / "finger.toml", "robot = \"base.toml\"\n"));
    REQUIRE(write_file(folder / "base.toml", "name = \"a\"\n"));
    REQUIRE(write_file(folder / "seen.csv", "tip_x_mm\n1\n"));
    const auto fingerprint = [&] {
        const auto plan = parsed(
            "command = [\"simulate\", \"finger.toml\", \"--measured=seen.csv\"]\nplan = \"grid\"\n" + modulus + tension,
            folder / "s.toml");
        REQUIRE(plan);
        return plan->fingerprint;
    };
    const std::string first = fingerprint();
    CHECK(fingerprint() == first);
    REQUIRE(write_file(folder / "base.toml", "name = \"b\"\n"));
    const std::string second = fingerprint();
    CHECK(second != first);
    REQUIRE(write_file(folder / "seen.csv", "tip_x_mm\n2\n"));
    CHECK(fingerprint() != second);
}

TEST_CASE("a change of a mesh, surface or table that a robot is read from gives another fingerprint") {
    const pliant::test::Folder folder("study");
    std::filesystem::create_directories(folder / "far");
    REQUIRE(write_file(folder / "finger.toml", "robot = \"far/middle.toml\"\n"));
    REQUIRE(write_file(folder / "far/middle.toml", "robot = \"base.toml\"\n"));
    REQUIRE(write_file(folder / "far/base.toml",
                       "mesh.file = \"m.vtk\"\nbody = [{ geometry = \"part.step\" }]\nobstacle = [{ surface = "
                       "\"wall.stl\" }]\ngoal = [{ path = \"way.csv\" }]\n"));
    const std::string keys =
        "key.mesh = { set = \"mesh.file\", values = [\"m.vtk\", \"n.vtk\"] }\n"
        "key.part = { values = [\"one\", \"two\"] }\n";
    const auto fingerprint = [&] {
        const auto plan = parsed(
            "command = [\"simulate\", \"finger.toml\", \"--set\", \"body.0.geometry='other.stl'\", "
            "\"--measured\", \"{part}.csv\"]\nplan = \"grid\"\n" +
                keys + tension,
            folder / "s.toml");
        REQUIRE_MESSAGE(plan, (plan ? "" : plan.error().message));
        return plan->fingerprint;
    };
    std::string last = fingerprint();
    for (const char* file : {"far/m.vtk", "far/part.step", "far/wall.stl", "far/way.csv", "far/n.vtk", "far/other.stl",
                             "one.csv", "two.csv", "far/middle.toml"}) {
        CAPTURE(file);
        for (const char* text : {"robot = \"base.toml\"\n#1", "robot = \"base.toml\"\n#2"}) {
            REQUIRE(write_file(folder / file, text));
            const std::string now = fingerprint();
            CHECK(now != last);
            CHECK(now == fingerprint());
            last = now;
        }
    }
    REQUIRE(write_file(folder / "far/stranger.vtk", "of another robot"));
    CHECK(fingerprint() == last);
}
