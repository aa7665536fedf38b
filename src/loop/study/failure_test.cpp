#include "loop/study/failure.hpp"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

using pliant::study::reason_of_failure;

namespace {

std::string reason(const std::string& output, const std::string& errors = "") {
    return reason_of_failure(nlohmann::json::parse(output, nullptr, false), errors, 1);
}

}  // namespace

TEST_CASE("a usage error is the last line that is not empty") {
    const std::string error = "pliant simulate: --steps: write a whole number from 1 to 100000, not 0";
    CHECK(reason("", "note: first\n" + error + "\n") == error);
    CHECK(reason("", error + "\r\n\r\n") == error);
    CHECK(reason("", "\n\n") == "exit status 1");
}

TEST_CASE("an unreachable goal fails a row with the first waypoint that was missed, and why") {
    const std::string waypoints = R"("waypoints": [{"reached": true, "reasons": []},
        {"reached": false, "reasons": ["a is slack, and would have to push", "b is at the upper end of its range"]},
        {"reached": false, "reasons": ["later"]}]})";
    CHECK(reason(R"({"reached": false, "message": "", )" + waypoints, "r.toml: warning: from rest\n") ==
          "waypoint 2 of 3 is not reached: a is slack, and would have to push; b is at the upper end of its range");
    CHECK(reason(R"({"reached": false, "message": "stopped at waypoint 4 of 5: no equilibrium", )" + waypoints,
                 "r.toml: stopped at waypoint 4 of 5: no equilibrium\n") ==
          "r.toml: stopped at waypoint 4 of 5: no equilibrium");
    CHECK(reason(R"({"waypoints": [{"reached": false}]})") == "waypoint 1 of 1 is not reached");
}

TEST_CASE("an error in the JSON comes first; without anything the exit status is all there is") {
    CHECK(reason(R"({"error": "first\nfinger.toml: no equilibrium"})", "other") == "finger.toml: no equilibrium");
    CHECK(reason(R"({"waypoints": [1, {"reached": true}], "error": 3})", "said\n") == "said");
    CHECK(reason("[]") == "exit status 1");
}
