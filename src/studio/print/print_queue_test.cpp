#include "studio/print/print_queue.hpp"

#include <doctest/doctest.h>

#include "base/core/test_folder.hpp"
#include "base/core/test_text.hpp"
#include "studio/make/slice_robot.hpp"
#include "studio/make/test_orders.hpp"

using namespace pliant;
using namespace pliant::studio;
using pliant::test::holds;
using studio::test::Events;
using studio::test::Json;

TEST_CASE("a queue is kept when the studio ends, and a print that begins is removed from it") {
    const pliant::test::Folder folder;
    const ProjectFolder project = ProjectFolder::open(folder.path()).value();
    Progress silent;
    JobUnderWay unseen;
    const auto made = slice_robot(studio::test::slice_order(), folder / "bar.zip", silent, unseen);
    REQUIRE_MESSAGE(made, (made ? "" : made.error().message));
    Events events;
    const auto tell = [&](const std::string& json) { events.add(json); };
    {
        PrintQueue queue(project, tell);
        CHECK(queue.jobs().empty());
        REQUIRE(queue.set({"BAR.ZIP"}).has_value());
        REQUIRE(queue.set({"bar.zip", "gone.zip", "bar.zip"}).has_value());
        CHECK(events.count("queue") == 2);
    }
    PrintQueue queue(project, tell);
    CHECK(queue.jobs() == std::vector<std::string>{"bar.zip", "gone.zip", "bar.zip"});
    const Json told = Json::parse(queue.json())["jobs"];
    REQUIRE(told.size() == 3);
    CHECK(told[0]["title"] == "bar");
    CHECK(told[0]["layers"] == 40);
    CHECK(told[0]["seconds"] > 40 * 2.0);  // longer than its light
    CHECK(holds(told[1]["error"].get<std::string>(), "gone.zip"));
    queue.begun("bar.zip");
    CHECK(queue.jobs() == std::vector<std::string>{"gone.zip", "bar.zip"});
    queue.begun("other.zip");
    CHECK(queue.jobs().size() == 2);
}

TEST_CASE("invalid jobs are not queued, and a damaged queue file is an empty queue") {
    const pliant::test::Folder folder;
    const ProjectFolder project = ProjectFolder::open(folder.path()).value();
    REQUIRE(write_file(folder / PrintQueue::file_name, "[1, 2").has_value());
    PrintQueue queue(project, [](const std::string&) {});
    CHECK(queue.jobs().empty());
    CHECK(holds(queue.set({"../bar.zip"}).error().message, ".."));
    CHECK(holds(queue.set({"robot.toml"}).error().message, "a job (.zip) is needed"));
    CHECK(holds(queue.set(std::vector<std::string>(51, "a.zip")).error().message, "at most 50"));
    CHECK(queue.jobs().empty());
}
