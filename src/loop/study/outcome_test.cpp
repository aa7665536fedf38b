#include "loop/study/outcome.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/core/files.hpp"
#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "base/zip/zip_file.hpp"
#include "loop/study/npy.hpp"

using namespace pliant;
using namespace pliant::study;

namespace {

Plan three_rows() {
    Plan plan;
    plan.study = "three";
    plan.version = "1.0";
    plan.command = {"simulate", "a.toml"};
    plan.keys = {{"modulus", "m", "", "MPa", true}, {"law", "l", "", "", false}};
    plan.results = {{"tension", "t"}, {"tip, up", "u"}};
    plan.rows = {{"5", "yeoh"}, {"10", "neo-hookean"}, {"20", "yeoh"}};
    return plan;
}

Collected three_collected() {
    Collected all;
    all.rows = {RowRecord{0, true, false, "", {1.5, 0.1}, 1, 0.5},
                RowRecord{1, false, false, "step 3: no \"balance\", sorry", {9, 9}, 2, 1},
                RowRecord{2, true, false, "", {2.5, NAN}, 1, 0.5, false, "below a vacuum; no balance"}};
    all.done = 2;
    all.failed = 1;
    all.warned = 1;
    all.tasks = {{"node1", 3, 2, 2}, {"node2", 1, 1, 1}, {"node1", 1, 1, 1}};
    return all;
}

}  // namespace

TEST_CASE("results.csv has keys with units, results of finished rows, and reasons of failures and warnings") {
    CHECK(results_csv(three_rows(), three_collected()) ==
          "row,modulus (MPa),law,tension,\"tip, up\",status,reason,warning\n"
          "0,5,yeoh,1.5,0.1,done,,\n"
          "1,10,neo-hookean,,,failed,\"step 3: no \"\"balance\"\", sorry\",\n"
          "2,20,yeoh,2.5,,done,,\"below a vacuum; no balance\"\n");
}

TEST_CASE("the summary counts rows, and adds up the time of each machine") {
    const Plan plan = three_rows();
    const auto json =
        nlohmann::json::parse(summary_json(plan, three_collected(), figures_of(plan, three_collected()), nullptr));
    CHECK(json["rows"] == 3);
    CHECK(json["done"] == 2);
    CHECK(json["failed"] == 1);
    CHECK(json["missing"] == 0);
    CHECK(json["results"]["tension"]["mean"] == 2.0);
    CHECK(json["results"]["tension"]["standard_deviation"].get<double>() == near(std::sqrt(0.5), {.relative = 1e-12}));
    CHECK(json["results"]["tip, up"]["rows"] == 1);
    CHECK(json["failures"][0]["row"] == 1);
    CHECK(json["warned"] == 1);
    CHECK(json["warnings"][0]["row"] == 2);
    CHECK(json["warnings"][0]["warning"] == "below a vacuum; no balance");
    CHECK(json["accounts"]["places"]["node1"]["cpu_s"] == 3.0);
    CHECK(json["accounts"]["rows_cpu_s"] == 2.0);
}

TEST_CASE("arrays have the bytes that numpy writes") {
    // numpy.save of array([1.0, -0.5]): 128 bytes of header, then little-endian doubles.
    const std::string numbers = npy_numbers(std::vector{1.0, -0.5});
    CHECK(numbers.size() == 128 + 16);
    CHECK(numbers.substr(0, 10) == std::string("\x93NUMPY\x01\x00\x76\x00", 10));
    CHECK(numbers.find("{'descr': '<f8', 'fortran_order': False, 'shape': (2,), }") == 10);
    CHECK(numbers[127] == '\n');
    CHECK(numbers.substr(128) == std::string("\x00\x00\x00\x00\x00\x00\xf0\x3f\x00\x00\x00\x00\x00\x00\xe0\xbf", 16));
    const std::string texts = npy_texts(std::vector<std::string>{"aé", "\xff"});
    CHECK(texts.find("'<U2'") != std::string::npos);
    CHECK(texts.substr(texts.size() - 16) == std::string("a\0\0\0\xe9\0\0\0\xfd\xff\0\0\0\0\0\0", 16));
    const std::string cut = npy_texts(std::vector<std::string>{"éé", "abcde"}, 3);
    CHECK(cut.find("'<U3'") != std::string::npos);
    CHECK(cut.substr(cut.size() - 24) == std::string("\xe9\0\0\0\xe9\0\0\0\0\0\0\0a\0\0\0b\0\0\0c\0\0\0", 24));
    CHECK(npy_truths({true, false}).ends_with(std::string("\1\0", 2)));
}

TEST_CASE("all tables are written, and the archive holds every key and result") {
    const pliant::test::Folder folder("outcome");
    const Plan plan = three_rows();
    REQUIRE(write_outcome(plan, folder.path(), three_collected(), figures_of(plan, three_collected()), "{}"));
    const auto zip = ZipReader::open(folder / "results.npz");
    REQUIRE(zip);
    for (const char* name : {"key.modulus.npy", "key.law.npy", "result.tension.npy", "result.tip, up.npy", "done.npy",
                             "reason.npy", "warning.npy"})
        CHECK(zip->has(name));
    CHECK(zip->read("result.tension.npy", 1000)->size() == 128 + 24);
    CHECK(read_file(folder / "times.csv").value() ==
          "row,wall_s,cpu_s\n0,1.000000,0.500000\n1,2.000000,1.000000\n2,1.000000,0.500000\n");
}
