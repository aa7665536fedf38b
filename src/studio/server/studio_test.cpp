// The studio without its network server: files, edits, live states, routes.
#include "studio/server/studio.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>
#include <tuple>

#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"
#include "base/core/test_text.hpp"
#include "robot/file/robot_file.hpp"
#include "studio/files/test_surface.hpp"
#include "studio/make/make_session.hpp"
#include "studio/make/test_orders.hpp"

using namespace pliant;
using namespace pliant::studio;
namespace fs = std::filesystem;
using Json = nlohmann::json;
using pliant::test::holds;

namespace {

constexpr const char* project_bar = R"(name = "bar"
length_unit = "mm"
material.soft = { youngs_modulus = "1 MPa", poisson_ratio = 0.45, resin = "semi-flex" }
body = [{ name = "bar", material = "soft", geometry = { box = [[0, 0, 0], [40, 10, 10]] } }]
fixed = [{ name = "clamp", box = [[0, 0, 0], [0, 10, 10]] }]
marker = [{ name = "tip", point = [40, 5, 5] }]
mesh = { size = "6 mm" }
[[cable]]
name = "flexor"
points = [[0, 5, 9], [20, 5, 9], [40, 5, 9]]
target = { shortening = "2 mm" }
)";

struct Project {
    pliant::test::Folder folder{"studio"};
    fs::path base = folder.path();
    Project() {
        fs::create_directories(base / "project");
        std::ofstream(base / "project" / "bar.toml") << project_bar;
        std::ofstream(base / "outside.stl") << "solid x\nendsolid x\n";
    }
};

/// An empty studio, or one with a file.
std::unique_ptr<Studio> opened(const fs::path& file = {}) {
    auto studio = Studio::open({file, "test"});
    REQUIRE(studio);
    return std::move(*studio);
}

/// With the bar of a project.
std::unique_ptr<Studio> opened(const Project& project) {
    return opened(project.base / "project" / "bar.toml");
}

/// With a robot of a project, once its model is built.
std::unique_ptr<Studio> built(const Project& project, const std::string& robot = "bar.toml") {
    auto studio = opened(project.base / "project" / robot);
    REQUIRE(studio->simulation().wait_until_built());
    return studio;
}

/// A page that has identified itself.
std::shared_ptr<Connection> joined(Studio& studio, const std::string& name) {
    auto page = studio.join();
    studio.receive(page, Json{{"type", "hello"}, {"page", name}}.dump());
    return page;
}

Json head_of(const std::string& packet) {
    REQUIRE(packet.size() > 8);
    std::uint32_t length = 0;
    std::memcpy(&length, packet.data() + 4, 4);
    return Json::parse(packet.substr(8, length))["head"];
}

/// The head of the frame that answers input `tag` at equilibrium.
Json arrived(Studio& studio, const std::shared_ptr<Connection>& connection, double tag) {
    for (;;) {
        const auto out = connection->next();
        REQUIRE(out);
        if (!out->binary) continue;
        const Json head = head_of(*out->bytes);
        if (head["tag"] == tag && head["arrived"] == true) return head;
        (void)studio;
    }
}

/// The next refusal.
Json next_error(const std::shared_ptr<Connection>& connection) {
    for (;;) {
        const auto out = connection->next();
        REQUIRE(out);
        if (out->binary) continue;
        Json event = Json::parse(*out->bytes);
        if (event["type"] == "error") return event;
    }
}

Response ask(Studio& studio, const std::string& method, const std::string& path, const std::string& body = "",
             const std::string& page = "") {
    Request request{method, path};
    request.body = body;
    request.page = page;
    return studio.handle(request);
}

std::string file_text(const fs::path& path) {
    std::ifstream file(path);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

}  // namespace

TEST_CASE("a robot is opened, bent, edited, undone and saved") {
    const Project project;
    const auto owner = built(project);
    Studio& studio = *owner;
    const Json scene = head_of(ask(studio, "GET", "/api/scene").body);
    CHECK(scene["robot"] == "bar");
    CHECK(scene["actuators"][0]["kind"] == "shortening_mm");
    CHECK(scene["actuators"][0]["rest"].get<double>() == near(40, {.relative = 1e-12}));

    const auto page = joined(studio, "first_page");
    studio.receive(page,
                   R"({"type":"drive","tag":1,"actuators":[{"name":"flexor","kind":"shortening_mm","value":2}]})");
    const Json bent = arrived(studio, page, 1);
    CHECK(bent["residual"].get<double>() <= 1e-4);
    CHECK(bent["cables"][0]["length_mm"].get<double>() == near(38, {.relative = 1e-6}));
    studio.receive(page, R"({"type":"follow","tag":2,"time":1})");  // the program ends at the same place
    const Json followed = arrived(studio, page, 2);
    for (int k = 0; k < 3; ++k)
        CHECK(followed["markers"][0][k].get<double>() ==
              near(bent["markers"][0][k].get<double>(), {.relative = 1e-12}));

    std::string stiffer = project_bar;
    stiffer.replace(stiffer.find("1 MPa"), 5, "2 MPa");
    REQUIRE(ask(studio, "PUT", "/api/robot", stiffer, "first_page").status == 200);
    REQUIRE(studio.simulation().wait_until_built());
    CHECK(head_of(ask(studio, "GET", "/api/scene").body)["materials"][0]["youngs_modulus_MPa"] == 2);
    studio.receive(page, R"({"type":"follow","tag":3,"time":1})");
    const Json stiff = arrived(studio, page, 3);
    CHECK(stiff["cables"][0]["tension_N"].get<double>() ==
          near(2 * bent["cables"][0]["tension_N"].get<double>(), {.relative = 1e-2}));

    CHECK(ask(studio, "POST", "/api/robot/save", "{}", "first_page").status == 200);
    CHECK(file_text(project.base / "project" / "bar.toml") == stiffer);
    CHECK(ask(studio, "POST", "/api/robot/undo", "", "first_page").status == 200);
    CHECK(ask(studio, "GET", "/api/robot").body == project_bar);
    CHECK(ask(studio, "POST", "/api/robot/redo", "", "first_page").status == 200);
    CHECK(ask(studio, "GET", "/api/robot").body == stiffer);
    CHECK(ask(studio, "POST", "/api/robot/save", R"({"name":"../evil.toml"})", "first_page").status == 422);
    CHECK(ask(studio, "POST", "/api/robot/save", "{", "first_page").status == 422);
    CHECK(ask(studio, "POST", "/api/print/host/job", "{", "first_page").status == 400);  // the host's own statuses
    CHECK_FALSE(fs::exists(project.base / "evil.toml"));
    CHECK(ask(studio, "POST", "/api/robot/save", R"({"name":"copy.toml"})", "first_page").status == 200);
    CHECK(fs::exists(project.base / "project" / "copy.toml"));

    for (const char* name : {"steps.csv", "markers.csv", "robot.glb", "robot.vtu"})
        CHECK_MESSAGE(ask(studio, "GET", std::string("/api/export/") + name).status == 200, name);
}

TEST_CASE("a new robot is never saved over a file that was not opened") {
    const Project project;
    const auto owner = built(project);
    Studio& studio = *owner;
    const auto page = joined(studio, "first_page");
    REQUIRE(write_file(project.base / "project" / "robot.toml", "# mine\n"));
    REQUIRE(write_file(project.base / "project" / "cable_gripper.toml", "# mine\n"));
    const auto save_as = [&](const std::string& name) {
        return ask(studio, "POST", "/api/robot/save", R"({"name":")" + name + R"("})", "first_page");
    };
    REQUIRE(ask(studio, "POST", "/api/robot/new", project_bar, "first_page").status == 200);
    CHECK(save_as("robot.toml").status == 422);
    studio.open_example("cable_gripper");
    CHECK(holds(save_as("cable_gripper.toml").body, "exists; choose another name"));
    CHECK(file_text(project.base / "project" / "robot.toml") == "# mine\n");
    CHECK(file_text(project.base / "project" / "cable_gripper.toml") == "# mine\n");
    CHECK(save_as("gripper.toml").status == 200);
    CHECK(save_as("gripper.toml").status == 200);
}

TEST_CASE("a file whose lines end with CR LF is edited with LF, and saved with its own ends") {
    const Project project;
    const fs::path file = project.base / "project" / "windows.toml";
    std::string text = project_bar;
    for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) text.insert(at, "\r");
    REQUIRE(write_file(file, text));
    const auto owner = built(project);
    Studio& studio = *owner;
    const auto page = joined(studio, "first_page");
    REQUIRE(ask(studio, "POST", "/api/open", R"({"name":"windows.toml"})", "first_page").status == 200);
    CHECK(studio.document().text == project_bar);
    CHECK(studio.document().text == studio.document().saved);
    REQUIRE(ask(studio, "POST", "/api/robot/set", R"({"changes":[{"key":"mesh.size","value":"7 mm"}]})", "first_page")
                .status == 200);
    REQUIRE(ask(studio, "POST", "/api/robot/save", R"({"name":""})", "first_page").status == 200);
    const std::string saved = read_file(file).value();
    CHECK(std::ranges::count(saved, '\n') == std::ranges::count(text, '\n'));
    CHECK(std::ranges::count(saved, '\r') == std::ranges::count(text, '\n'));
    CHECK(holds(saved, "7 mm"));
}

TEST_CASE("in a file that stands on another one, values go into its list of changes, and nothing is added") {
    const Project project;
    const auto owner = built(project);
    Studio& studio = *owner;
    const auto page = joined(studio, "first_page");
    const auto post = [&](const std::string& path, const std::string& body) {
        return ask(studio, "POST", path, body, "first_page");
    };
    REQUIRE(post("/api/robot/new", "# mine\nrobot = \"bar.toml\"\nset = [\"mesh.order=1\", 'mesh.size=\"8 mm\"']\n")
                .status == 200);
    const auto set = [&](const std::string& key, const std::string& value) {
        const Json change = {{"key", key}, {"value", value}};
        return post("/api/robot/set", Json({{"changes", {change}}}).dump()).status;
    };
    CHECK(set("mesh.size", "7 mm") == 200);
    CHECK(set("material.soft.youngs_modulus", "2 MPa") == 200);
    CHECK(set("program.duration", "2 s") == 200);
    const std::string text = studio.document().text;
    CHECK(text.starts_with("# mine\nrobot = \"bar.toml\"\n"));
    const auto robot = robot::parse_robot(text, studio.document().file);
    REQUIRE_MESSAGE(robot, (robot ? "" : robot.error().message));
    CHECK(robot->program.duration == 2);
    CHECK(robot->materials[0].youngs_modulus_Pa == 2e6);
    CHECK_FALSE(holds(text, "8 mm"));
    const Response added = post("/api/robot/add", R"({"list":"marker","entry":{"name":"m","point":[1,2,3]}})");
    CHECK(added.status == 422);
    CHECK(holds(added.body, "this file only changes bar.toml: open that file to add a marker"));
    CHECK(studio.document().text == text);
}

TEST_CASE("a robot is not saved where the files that it names are not found") {
    const Project project;
    const auto owner = built(project);
    Studio& studio = *owner;
    const auto page = joined(studio, "first_page");
    fs::create_directory(project.base / "project" / "sub");
    const auto save_as = [&](const std::string& name) {
        return ask(studio, "POST", "/api/robot/save", R"({"name":")" + name + R"("})", "first_page");
    };
    REQUIRE(ask(studio, "POST", "/api/robot/new", "robot = \"bar.toml\"\n", "first_page").status == 200);
    const Response moved = save_as("sub/based.toml");
    CHECK(moved.status == 422);
    CHECK(holds(moved.body, "bar.toml"));
    CHECK_FALSE(fs::exists(project.base / "project" / "sub" / "based.toml"));
    CHECK(save_as("based.toml").status == 200);
    // It names no file; and what is in error here anyway may be kept anywhere.
    REQUIRE(ask(studio, "POST", "/api/robot/new", project_bar, "first_page").status == 200);
    CHECK(save_as("sub/bar.toml").status == 200);
    REQUIRE(ask(studio, "POST", "/api/robot/new", "robot = \"later.toml\"\n", "first_page").status == 200);
    CHECK(save_as("sub/unfinished.toml").status == 200);
}

TEST_CASE("a changed robot goes to the state that was wanted before; another robot starts from rest") {
    const Project project;
    const auto owner = built(project);
    Studio& studio = *owner;
    const auto page = joined(studio, "first_page");
    studio.receive(page, R"({"type":"follow","tag":1,"time":0.5})");
    CHECK(arrived(studio, page, 1)["cables"][0]["length_mm"].get<double>() == near(39, {.relative = 1e-5}));
    const std::int64_t first = studio.simulation().built()->revision;
    const auto arrived_anew = [&](int built_after, double time) {
        for (;;) {
            const auto out = page->next();
            REQUIRE(out);
            if (!out->binary) continue;
            const Json head = head_of(*out->bytes);
            if (head["revision"] == first + built_after && head["arrived"] == true && head["time"] == time) return head;
        }
    };
    std::string stiffer = project_bar;
    stiffer.replace(stiffer.find("1 MPa"), 5, "2 MPa");
    REQUIRE(ask(studio, "PUT", "/api/robot", stiffer, "first_page").status == 200);
    const Json followed = arrived_anew(1, 0.5);
    CHECK(followed["cables"][0]["length_mm"].get<double>() == near(39, {.relative = 1e-5}));
    CHECK(followed["wanted"]["time"] == 0.5);
    CHECK(followed["wanted"]["actuators"].empty());

    studio.receive(page,
                   R"({"type":"drive","tag":2,"actuators":[{"name":"flexor","kind":"shortening_mm","value":1.5}]})");
    (void)arrived(studio, page, 2);
    REQUIRE(ask(studio, "POST", "/api/robot/undo", "", "first_page").status == 200);
    REQUIRE(studio.simulation().wait_until_built());
    Json driven = arrived_anew(2, 0.5);
    while (driven["cables"][0]["length_mm"].get<double>() > 38.6) driven = arrived_anew(2, 0.5);
    CHECK(driven["wanted"]["actuators"][0] == Json{{"name", "flexor"}, {"kind", "shortening_mm"}, {"value", 1.5}});

    REQUIRE(ask(studio, "POST", "/api/open", R"({"name":"bar.toml"})", "first_page").status == 200);
    const Json fresh = arrived_anew(3, 0);
    CHECK(fresh["cables"][0]["length_mm"].get<double>() == near(40, {.relative = 1e-12}));
    CHECK(fresh["wanted"]["time"] == 0);
}

TEST_CASE("what the robot cannot do is answered by the reason, and never by a frame") {
    const Project project;
    const auto owner = built(project);
    Studio& studio = *owner;
    const auto page = joined(studio, "first_page");
    const auto drive = [](const std::string& name, const std::string& kind, double value) {
        return Json{{"name", name}, {"kind", kind}, {"value", value}};
    };
    const auto driven = [](const Json& actuators) { return Json{{"type", "drive"}, {"actuators", actuators}}; };
    const Json good = drive("flexor", "shortening_mm", 1);
    double tag = 100;
    for (auto [message, why] : {
             std::pair(driven(Json::array({drive("nobody", "shortening_mm", 1)})),
                       R"(message: actuators: there is no actuator "nobody"; the robot has "flexor")"),
             {driven(Json::array({good, drive("flexor", "volume_ratio", 1)})),
              "message: actuators: \"flexor\" has no volume_ratio; it is driven by length_ratio, shortening_mm and "
              "tension_N"},
             {driven(Json::array({drive("flexor", "length_ratio", -3)})),
              "message: actuators: \"flexor\": length_ratio is -3; it must be over 0"},
             {driven(Json::array({drive("flexor", "shortening_mm", 40)})),
              "message: actuators: \"flexor\": shortening_mm is 40; it must be under 40, the length at rest"},
             {driven(Json::array({drive("flexor", "tension_N", -1)})),
              "message: actuators: \"flexor\": tension_N is -1; it must be at least 0: a cable cannot push"},
             {driven(Json::array({good, good})), "message: actuators: \"flexor\" is named twice"},
             {Json{{"type", "drive"}, {"time", 1.5}, {"actuators", Json::array({good})}},
              "message: time is 1.5; the program goes from 0 to 1"},
             {Json{{"type", "follow"}, {"time", 2}}, "message: time is 2; the program goes from 0 to 1"},
             {Json{{"type", "lead"}, {"marker", "nose"}, {"to", {0, 0, 0}}},
              R"(message: marker: there is no marker "nose"; the robot has "tip")"},
         }) {
        message["tag"] = ++tag;
        studio.receive(page, message.dump());
        const Json answer = next_error(page);
        CHECK(answer["error"] == why);
        CHECK(answer["tag"] == tag);
    }
    studio.receive(page, R"({"type":"pull","tag":1,"vertex":1000000,"to":[0,0,0]})");
    CHECK(holds(next_error(page)["error"].get<std::string>(), "message: vertex is 1000000; the robot has "));
    studio.receive(page, R"({"type":"fields","names":["J","K"]})");
    CHECK(next_error(page)["error"] ==
          "message: names: there is no field \"K\"; there are J, von_mises, stretch and energy");
    // None of it reached the robot.
    studio.receive(page, Json{{"type", "drive"}, {"tag", 200}, {"actuators", Json::array()}}.dump());
    const Json still = arrived(studio, page, 200);
    CHECK(still["wanted"]["actuators"].empty());
    CHECK(still["cables"][0]["length_mm"].get<double>() == near(40, {.relative = 1e-9}));
}

TEST_CASE("air elements are driven by volume and have no pressure") {
    const Project project;
    std::ofstream(project.base / "project" / "bar.toml", std::ios::app)
        << "[[chamber]]\nname = \"air\"\nmodel = \"elements\"\ntarget = { volume_ratio = 1.2 }\n"
           "geometry = { box = [[5, 3, 2], [35, 7, 5]] }\n";
    const auto owner = built(project);
    Studio& studio = *owner;
    const auto page = joined(studio, "first_page");
    studio.receive(page, R"({"type":"drive","tag":1,"actuators":[{"name":"air","kind":"volume_ratio","value":1.15}]})");
    const Json blown = arrived(studio, page, 1);
    CHECK(blown["chambers"][0]["ratio"].get<double>() == near(1.15, {.relative = 1e-5}));
    CHECK(blown["chambers"][0]["pressure_kPa"].get<double>() > 1);
    studio.receive(page, R"({"type":"drive","tag":2,"actuators":[{"name":"air","kind":"pressure_kPa","value":50}]})");
    CHECK(next_error(page)["error"] ==
          "message: actuators: \"air\" has no pressure_kPa; it is driven by volume_ratio and volume_change_mm3");
    studio.receive(page, R"({"type":"drive","tag":3,"actuators":[]})");
    const Json still = arrived(studio, page, 3);
    CHECK(still["chambers"][0]["ratio"].get<double>() == near(1.15, {.relative = 1e-5}));
    CHECK(still["wanted"]["actuators"] == Json{{{"name", "air"}, {"kind", "volume_ratio"}, {"value", 1.15}}});
}

TEST_CASE("a page that reconnects is told that there is no job and no machine") {
    const Project project;
    const auto owner = opened(project);
    Studio& studio = *owner;
    CHECK(studio.make().news() == std::vector<std::string>{R"({"revision":0,"type":"job"})"});
    CHECK(studio.print().news() == std::vector<std::string>{R"({"type":"machine"})"});
    CHECK(ask(studio, "GET", "/api/print/verdict").body == "null");
}

TEST_CASE("warnings of the simulation reach the page with every frame") {
    const Project project;
    std::ofstream(project.base / "project" / "gripper.toml")
        << std::ifstream("examples/cable_gripper/gripper.toml").rdbuf() << "\n[contact]\nself = false\n";
    const auto owner = built(project, "gripper.toml");
    Studio& studio = *owner;
    const auto page = joined(studio, "first_page");
    const auto gaps_closed = [](const Json& head) {
        const auto& all = head["warnings"];
        return std::any_of(all.begin(), all.end(), [](const Json& w) {
            return w.get<std::string>().find("have met: the gap between them is closed") != std::string::npos;
        });
    };
    studio.receive(page, R"({"type":"follow","tag":1,"time":0.2})");
    CHECK_FALSE(gaps_closed(arrived(studio, page, 1)));
    // Further than its gaps are wide.
    studio.receive(page,
                   R"({"type":"drive","tag":2,"actuators":[{"name":"flexor","kind":"length_ratio","value":0.5}]})");
    for (;;) {
        const auto out = page->next();
        REQUIRE(out);
        if (!out->binary) continue;
        const Json head = head_of(*out->bytes);
        if (gaps_closed(head)) break;
        REQUIRE(head["stuck"] == "");
        REQUIRE_FALSE((head["tag"] == 2 && head["arrived"] == true));
    }
}

TEST_CASE("an error in the file is reported with its line, and the previous robot stays") {
    const Project project;
    const auto owner = built(project);
    Studio& studio = *owner;
    std::string wrong = project_bar;
    wrong.replace(wrong.find("poisson_ratio"), 13, "poison_ratio_");
    CHECK(ask(studio, "PUT", "/api/robot", wrong).status == 200);
    CHECK(studio.simulation().wait_until_built());
    Json problem;
    for (const std::string& news : studio.simulation().news()) {
        const Json event = Json::parse(news);
        if (event["type"] == "problem") problem = event["lines"];
    }
    REQUIRE(problem.is_array());
    CHECK(problem[0]["line"] == 3);
    CHECK(problem[0]["text"].get<std::string>().find("poison_ratio_") != std::string::npos);
    CHECK(head_of(ask(studio, "GET", "/api/scene").body)["robot"] == "bar");
}

TEST_CASE("a robot text from the page cannot read files outside the folder") {
    const Project project;
    const auto owner = opened(project);
    Studio& studio = *owner;
    for (const std::string& path : {std::string("../outside.stl"), (project.base / "outside.stl").string()}) {
        std::string text = project_bar;
        const std::string geometry = "{ box = [[0, 0, 0], [40, 10, 10]] }";
        text.replace(text.find(geometry), geometry.size(), "\"" + path + "\"");
        const Response response = ask(studio, "PUT", "/api/robot", text);
        CHECK(response.status == 422);
        CHECK(response.body.find("outside of the project folder") != std::string::npos);
    }
    CHECK(ask(studio, "GET", "/api/robot").body == project_bar);
    CHECK(ask(studio, "POST", "/api/open", R"({"name":"../outside.stl"})").status == 422);
    CHECK(ask(studio, "POST", "/api/open", R"({"name":"/etc/passwd"})").status == 422);
}

TEST_CASE("a robot that is based on another cannot read files outside the folder either") {
    const Project project;
    const auto owner = opened(project);
    Studio& studio = *owner;
    const auto answers = [&](const std::string& outside) {
        const std::string text = "robot = \"bar.toml\"\nset = [\"body.bar.geometry=\\\"" + outside + "\\\"\"]\n";
        const Json order = {{"printer", "tower"}, {"robot", text}};
        const Response edited = ask(studio, "PUT", "/api/robot", text);
        CHECK(edited.status == 422);
        std::string all = edited.body + ask(studio, "POST", "/api/robot/check", text).body +
                          ask(studio, "POST", "/api/job/estimate", order.dump()).body +
                          ask(studio, "POST", "/api/job/slice", order.dump()).body;
        for (std::size_t at = 0; (at = all.find(outside)) != std::string::npos;) all.erase(at, outside.size());
        return all;
    };
    const std::string there = answers((project.base / "outside.stl").string());
    CHECK(holds(there, "lies outside of the project folder"));
    CHECK(there == answers((project.base / "not_there.stl").string()));  // nobody learns which files there are
    CHECK(studio.document().text == project_bar);
}

TEST_CASE("a text that leads outside since its base has changed is not built, and in another folder not saved") {
    const Project project;
    const auto owner = built(project);
    Studio& studio = *owner;
    const auto page = joined(studio, "first_page");
    fs::create_directories(project.base / "project" / "parts");
    std::ofstream(project.base / "project" / "parts" / "base.toml") << project_bar;
    const std::string text = "robot = \"base.toml\"\nset = ['mesh.file=\"../outside.stl\"']\n";
    std::ofstream(project.base / "project" / "parts" / "own.toml") << text;
    REQUIRE(ask(studio, "POST", "/api/open", R"({"name":"parts/own.toml"})", "first_page").status == 200);
    const Response moved = ask(studio, "POST", "/api/robot/save", R"({"name":"own.toml"})", "first_page");
    CHECK(moved.status == 422);
    CHECK(holds(moved.body, "lies outside"));
    CHECK_FALSE(fs::exists(project.base / "project" / "own.toml"));

    const std::string based = "robot = \"parts/base.toml\"\n";
    std::ofstream(project.base / "project" / "based.toml") << based;
    REQUIRE(ask(studio, "POST", "/api/open", R"({"name":"based.toml"})", "first_page").status == 200);
    REQUIRE(studio.simulation().wait_until_built());
    std::ofstream(project.base / "project" / "parts" / "base.toml", std::ios::app) << "surface = \"../../x.stl\"\n";
    studio.look_at_files();
    while (!holds(next_error(page)["error"].get<std::string>(), "lies outside")) {
    }
    CHECK(ask(studio, "POST", "/api/job/slice", R"({"printer":"tower"})", "first_page").status == 422);
}

TEST_CASE("a sweep and an identification are of the robot that is shown, also when a file of it has changed") {
    const Project project;
    const auto owner = built(project);
    Studio& studio = *owner;
    const auto page = joined(studio, "first_page");
    std::ofstream(project.base / "project" / "base.toml") << project_bar;
    std::ofstream(project.base / "project" / "based.toml") << "robot = \"base.toml\"\n";
    REQUIRE(ask(studio, "POST", "/api/open", R"({"name":"based.toml"})", "first_page").status == 200);
    REQUIRE(studio.simulation().wait_until_built());
    std::int64_t shown = studio.simulation().built()->revision;
    for (const auto& [path, order] :
         {std::pair("/api/sweep", R"({"axes":[{"key":"mesh.size","unit":"mm","values":[1]}]})"),
          std::pair("/api/identify", R"({"unknowns":["none"],"csv":"","file":"t.csv","judge":""})")}) {
        std::ofstream(project.base / "project" / "base.toml", std::ios::app) << "# changed\n";
        (void)ask(studio, "POST", path, order, "first_page");
        CHECK_MESSAGE(studio.simulation().built()->revision == ++shown, path);
    }
}

TEST_CASE("a file that was changed elsewhere is not saved over unasked") {
    const Project project;
    const auto owner = opened(project);
    Studio& studio = *owner;
    const fs::path file = project.base / "project" / "bar.toml";
    const std::string mine = std::string(project_bar) + "# mine\n", theirs = std::string(project_bar) + "# theirs\n";
    REQUIRE(studio.edit(mine));
    REQUIRE(write_file(file, theirs));
    for (const char* body : {"{}", R"({"name":"bar.toml"})", R"({"overwrite":false})"}) {
        const Response answer = ask(studio, "POST", "/api/robot/save", body);
        CHECK(answer.status == 409);
        CHECK(Json::parse(answer.body)["changed"] == true);
        CHECK(holds(answer.body, "bar.toml has been changed elsewhere"));
    }
    CHECK(file_text(file) == theirs);
    REQUIRE(ask(studio, "POST", "/api/robot/save", R"({"overwrite":true})").status == 200);
    CHECK(file_text(file) == mine);
    REQUIRE(studio.undo());
    CHECK(ask(studio, "POST", "/api/robot/save", "{}").status == 200);
    fs::remove(file);
    REQUIRE(studio.redo());
    CHECK(ask(studio, "POST", "/api/robot/save", "{}").status == 200);
    CHECK(file_text(file) == mine);
}

TEST_CASE("a job whose file has changed is not printed, saved or shown as the one that was opened") {
    const Project project;
    const auto owner = opened(project);
    Studio& studio = *owner;
    studio::test::Events events;
    MakeSession session([&](const std::string& json) { events.add(json); }, "test");
    for (const char* name : {"one.zip", "TWO.ZIP"}) {
        events.clear();
        REQUIRE(session.slice(studio::test::slice_order()).has_value());
        REQUIRE(studio::test::end_of_slicing(events) == "");
        REQUIRE(session.save(project.base / "project" / name).has_value());
    }
    REQUIRE(ask(studio, "POST", "/api/open", R"({"name":"one.zip"})").status == 200);
    CHECK(ask(studio, "GET", "/api/job/layers/3/0").status == 200);
    fs::rename(project.base / "project" / "TWO.ZIP", project.base / "project" / "one.zip");
    for (const auto& [method, path, body] : {std::tuple("POST", "/api/print/twin", R"({"speed":10})"),
                                             {"POST", "/api/job/save", R"({"name":"new.zip"})"},
                                             {"GET", "/api/job/file", ""},
                                             {"GET", "/api/job/layers/3/0", ""},
                                             {"GET", "/api/job/part", ""}}) {
        const Response answer = ask(studio, method, path, body);
        CHECK_MESSAGE(answer.status == 409, path);
        CHECK_MESSAGE(holds(answer.body, "one.zip has changed since it was opened: open it again"), path);
    }
    CHECK(studio.print().files().job.empty());
    REQUIRE(ask(studio, "POST", "/api/open", R"({"name":"one.zip"})").status == 200);
    CHECK(ask(studio, "GET", "/api/job/layers/3/0").status == 200);
    CHECK(ask(studio, "GET", "/api/job/file").status == 200);
}

TEST_CASE("jobs are jobs whatever the case of their ending") {
    const Project project;
    const auto owner = opened(project);
    Studio& studio = *owner;
    studio::test::Events events;
    MakeSession session([&](const std::string& json) { events.add(json); }, "test");
    REQUIRE(session.slice(studio::test::slice_order()).has_value());
    REQUIRE(studio::test::end_of_slicing(events) == "");
    REQUIRE(session.save(project.base / "project" / "BAR.ZIP").has_value());
    CHECK(ask(studio, "POST", "/api/open", R"({"name":"BAR.ZIP"})").status == 200);
    CHECK(ask(studio, "POST", "/api/job/save", R"({"name":"COPY.Zip"})").status == 200);
    Request other{"GET", "/api/job/other"};
    other.query["name"] = "BAR.ZIP";
    CHECK(studio.handle(other).status == 200);
    Request picture{"GET", "/api/thumbnail"};
    picture.query["file"] = "BAR.ZIP";
    CHECK(studio.handle(picture).status == 200);
}

TEST_CASE("a page that is not in control cannot change anything") {
    const auto owner = opened();
    Studio& studio = *owner;
    const auto first = joined(studio, "first_page"), second = joined(studio, "second_page");
    CHECK(ask(studio, "PUT", "/api/robot", project_bar, "second_page").status == 423);
    CHECK(ask(studio, "PUT", "/api/robot", project_bar).status == 423);
    CHECK(ask(studio, "PUT", "/api/robot", project_bar, "first_page").status == 200);
    CHECK(ask(studio, "GET", "/api/robot", "", "second_page").body == project_bar);
    const auto stranger = studio.join();
    studio.receive(stranger, R"({"type":"play","on":true})");
    const auto answer = stranger->next();
    REQUIRE(answer);
    CHECK(answer->bytes->find("another page has control") != std::string::npos);
}

TEST_CASE("a robot is sliced, its layers and plan can be read, and slicing can be cancelled") {
    const Project project;
    const auto owner = opened(project);
    Studio& studio = *owner;
    CHECK(ask(studio, "GET", "/api/job").status == 404);
    const auto page = studio.join();
    const auto wait_for_end = [&] {
        for (;;) {
            const auto out = page->next();
            REQUIRE(out);
            if (out->binary) continue;
            const Json event = Json::parse(*out->bytes);
            if (event["type"] == "slicing" && event["stage"] == "") return event["error"].get<std::string>();
        }
    };
    REQUIRE(ask(studio, "POST", "/api/job/slice", R"({"printer":"tower","layer_um":500})").status == 200);
    CHECK(wait_for_end() == "");
    const Json job = Json::parse(ask(studio, "GET", "/api/job").body);
    CHECK(job["manifest"]["layers"].size() == 20);
    CHECK(job["plan"]["layers"] == 20);
    const Response image = ask(studio, "GET", "/api/job/layers/3/0");
    CHECK(image.type == "image/png");
    CHECK(image.body.substr(1, 3) == "PNG");
    for (const char* path :
         {"/api/job/layers/20/0", "/api/job/layers/-1/0", "/api/job/layers/0/7", "/api/job/layers/x/0"})
        CHECK_MESSAGE(ask(studio, "GET", path).status == 404, path);
    // Browsers keep what names the job by its key, which no other job has; a page may still ask for one before it.
    const auto of_job = [&](const char* path, const std::string& key) {
        Request request{"GET", path};
        request.query["job"] = key;
        return studio.handle(request);
    };
    const Response kept = of_job("/api/job/layers/3/0", job["key"]);
    CHECK(kept.keep);
    CHECK(kept.body == image.body);
    CHECK_FALSE(image.keep);
    for (const char* path : {"/api/job/layers/3/0", "/api/job/layers/900/0", "/api/job/part"})
        CHECK_MESSAGE(of_job(path, "of-another").status == 204, path);
    CHECK(Json::parse(ask(studio, "GET", "/api/job/compare").body).size() >= 5);
    CHECK(job["projector"]["width"] == 1920);
    // The job in 3D: slabs of runs of one material up to the height of the part.
    const Response part = ask(studio, "GET", "/api/job/part");
    CHECK(part.status == 200);
    const Json drawn = head_of(part.body);
    CHECK(drawn["kind"] == "drawn");
    CHECK(drawn["height_mm"] == job["manifest"]["layers"].back()["z_um"].get<double>() / 1000);
    CHECK(part.body == ask(studio, "GET", "/api/job/part").body);
    // The estimate before slicing agrees.
    const Json estimate =
        Json::parse(ask(studio, "POST", "/api/job/estimate", R"({"printer":"tower","layer_um":500})").body);
    CHECK(estimate["layers"] == job["plan"]["layers"]);
    CHECK(estimate["swaps"] == job["plan"]["swaps"]);
    CHECK(estimate["seconds"].get<double>() == near(job["plan"]["seconds"]["total"].get<double>(), {.relative = 0.01}));
    const auto problem = [&](const std::string& body) {
        return Json::parse(ask(studio, "POST", "/api/job/estimate", body).body)["problem"].get<std::string>();
    };
    CHECK(problem(R"({"printer":"tower","layer":"thick"})").starts_with("--layer: "));
    CHECK(problem(R"({"printer":"tower","support":"soft","support-tip":"9 apples"})").starts_with("--support-tip: "));
    CHECK(problem(R"({"printer":"tower","support":"soft","support-angle":"steep"})").starts_with("--support-angle "));
    CHECK(problem(R"({"printer":"tower","support":"nothing"})").starts_with("--support nothing: is neither "));
    CHECK(
        problem(R"({"printer":"tower","support":"soft","support-paint":"wish\nblock\n"})").starts_with("supports:1: "));
    CHECK(problem(R"({"printer":"tower","robot":"name = 3"})").starts_with("robot:1: "));  // of the body: no file
    CHECK(ask(studio, "POST", "/api/job/save", R"({"name":"bar.zip"})").status == 200);
    CHECK(ask(studio, "POST", "/api/open", R"({"name":"bar.zip"})").status == 200);

    for (const char* wrong : {R"({"printer":"no such"})", R"({"layer_um":-1})", R"({"copies":"two"})",
                              R"({"turn":[1]})", "[]", R"({"printer":7})"})
        CHECK_MESSAGE(ask(studio, "POST", "/api/job/slice", wrong).status == 422, wrong);
}

TEST_CASE("unknown paths are refused, and the API description and manual list every route") {
    const auto owner = opened();
    Studio& studio = *owner;
    CHECK(ask(studio, "GET", "/api/nothing").status == 404);
    CHECK(ask(studio, "GET", "/api/robot/").status == 404);
    CHECK(ask(studio, "DELETE", "/api/robot").status == 405);
    const Json description = Json::parse(ask(studio, "GET", "/api/openapi.json").body);
    CHECK(description["openapi"] == "3.0.3");
    const std::string manual = file_text("docs/reference/studio.md");
    for (const Route& route : studio.routes()) {
        CHECK_MESSAGE(description["paths"][route.path].contains(route.method == "GET"   ? "get"
                                                                : route.method == "PUT" ? "put"
                                                                                        : "post"),
                      route.path);
        CHECK_MESSAGE(manual.find("`" + route.path + "`") != std::string::npos, route.path);
    }
}

namespace {

/// A STEP-free body: the surface of a tetrahedron, in millimetres.
std::string tetra_stl() {
    std::string text = "solid t\n";
    for (const char* facet : {"0 0 0\nvertex 0 30 0\nvertex 30 0 0", "0 0 0\nvertex 30 0 0\nvertex 0 0 30",
                              "0 0 0\nvertex 0 0 30\nvertex 0 30 0", "30 0 0\nvertex 0 30 0\nvertex 0 0 30"})
        text += std::string("facet normal 0 0 0\nouter loop\nvertex ") + facet + "\nendloop\nendfacet\n";
    return text + "endsolid t\n";
}

Response put_file(Studio& studio, const std::string& name, const std::string& bytes, bool replace = false,
                  const std::string& page = "") {
    Request request{"PUT", "/api/files"};
    request.query = {{"name", name}, {"replace", replace ? "1" : "0"}};
    request.page = page;
    request.length = static_cast<long long>(bytes.size());
    std::size_t at = 0;
    request.more = [&](char* into, std::size_t most) {
        const std::size_t n = std::min(most, bytes.size() - at);
        std::memcpy(into, bytes.data() + at, n);
        at += n;
        return static_cast<long long>(n);
    };
    CHECK(studio.streams(request));
    return studio.handle(request);
}

}  // namespace

TEST_CASE("a file from the page becomes a body of a robot, and replaces another file only on request") {
    const Project project;
    const auto owner = opened(project);
    Studio& studio = *owner;
    const Response sent = put_file(studio, "part.stl", tetra_stl());
    REQUIRE_MESSAGE(sent.status == 200, sent.body);
    const Json content = Json::parse(sent.body);
    CHECK(content["kind"] == "surface");
    CHECK(content["high"][0].get<double>() == near(30, {.relative = 1e-6}));
    CHECK(put_file(studio, "part.stl", tetra_stl()).status == 200);  // the same again
    std::string other = tetra_stl();
    other.replace(other.find("30"), 2, "31");
    CHECK(put_file(studio, "part.stl", other).status == 409);
    CHECK(file_text(project.base / "project" / "part.stl") == tetra_stl());
    CHECK(put_file(studio, "../part.stl", tetra_stl()).status == 422);
    CHECK(put_file(studio, "bar.toml", tetra_stl(), true).status == 422);
    CHECK(file_text(project.base / "project" / "bar.toml") == project_bar);
    CHECK(ask(studio, "PUT", "/api/files").status == 422);
    const auto page = joined(studio, "first_page");
    CHECK(put_file(studio, "other.stl", tetra_stl(), false, "second_page").status == 423);

    const std::string robot =
        "name = \"part\"\nlength_unit = \"mm\"\n[[body]]\nname = \"part\"\nmaterial = "
        "\"dragon-skin-30\"\ngeometry = \"part.stl\"\n[mesh]\nsize = \"12 mm\"\n[[fixed]]\nname = "
        "\"base\"\nbox = [[-1, -1, -1], [31, 31, 1]]\n";
    REQUIRE(ask(studio, "POST", "/api/robot/new", robot, "first_page").status == 200);
    REQUIRE(studio.simulation().wait_until_built());
    CHECK(head_of(ask(studio, "GET", "/api/scene").body)["robot"] == "part");
}

TEST_CASE("robots have thumbnails; invalid files have none") {
    const Project project;
    std::ofstream(project.base / "project" / "wrong.toml") << "name = 3\n";
    std::string outside = project_bar;
    const std::string geometry = "{ box = [[0, 0, 0], [40, 10, 10]] }";
    outside.replace(outside.find(geometry), geometry.size(), "\"../outside.stl\"");
    std::ofstream(project.base / "project" / "outside.toml") << outside;
    const auto owner = opened(project);
    const auto thumbnail = [&](const char* key, const std::string& value) {
        Request request{"GET", "/api/thumbnail"};
        request.query = {{key, value}};
        return owner->handle(request);
    };
    const Response mine = thumbnail("file", "bar.toml");
    REQUIRE(mine.status == 200);
    CHECK(mine.type == "image/png");
    CHECK(mine.body.substr(1, 3) == "PNG");
    CHECK(thumbnail("file", "bar.toml").body == mine.body);
    CHECK(thumbnail("example", "pneunet").status == 200);
    CHECK(thumbnail("example", "no such").status == 404);
    std::ofstream(project.base / "project" / "wrong.zip") << "PK no job";
    for (const char* name : {"wrong.toml", "outside.toml", "none.toml", "../outside.stl", "wrong.zip", "none.zip"})
        CHECK_MESSAGE(thumbnail("file", name).status >= 400, name);
    studio::test::Events events;
    MakeSession session([&](const std::string& json) { events.add(json); }, "test");
    REQUIRE(session.slice(studio::test::slice_order()).has_value());
    REQUIRE(studio::test::end_of_slicing(events) == "");
    REQUIRE(session.save(project.base / "project" / "bar.zip").has_value());
    CHECK(thumbnail("file", "bar.zip").body == session.job()->archive.file(job::thumbnail_file).value());
}

TEST_CASE("the robot has a picture before it is built, in light and dark; one with an error has none") {
    const Project project;
    const auto owner = opened(project);
    const auto picture = [&](const std::string& theme) {
        Request request{"GET", "/api/picture"};
        request.query = {{"theme", theme}};
        return owner->handle(request);
    };
    const Response light = picture("light"), dark = picture("dark");
    REQUIRE(light.status == 200);
    CHECK(light.type == "image/png");
    CHECK(light.body.substr(1, 3) == "PNG");
    REQUIRE(dark.status == 200);
    CHECK(light.body != dark.body);
    CHECK(picture("").body == light.body);

    std::stop_source stopped;
    stopped.request_stop();
    std::string other = project_bar;
    other.replace(other.find("[40, 10, 10]"), 12, "[40, 10, 20]");
    REQUIRE(owner->edit(other));
    CHECK(owner->first_picture(false, stopped.get_token()) == nullptr);
    CHECK(picture("light").status == 200);  // what was stopped is drawn when asked for again
    CHECK(picture("light").body != light.body);

    (void)owner->edit("name = 3\n");
    CHECK(picture("light").status == 204);
}

TEST_CASE("the robot has a picture although it names a file outside the folder, but text from a page gets none") {
    const Project project;
    std::ofstream(project.base / "tetra.stl") << studio::test::tetra(9);
    std::string outside = project_bar;
    const std::string geometry = "{ box = [[0, 0, 0], [40, 10, 10]] }";
    outside.replace(outside.find(geometry), geometry.size(), "\"../tetra.stl\"");
    std::ofstream(project.base / "project" / "outside.toml") << outside;
    const auto owner = opened(project.base / "project" / "outside.toml");
    CHECK(owner->first_picture(false) != nullptr);
    CHECK(ask(*owner, "GET", "/api/thumbnail?file=outside.toml").status >= 400);

    fs::copy_file(project.base / "tetra.stl", project.base / "secret.stl");
    std::string secret = outside;
    secret.replace(secret.find("tetra.stl"), 9, "secret.stl");
    Thumbnails pictures;
    const fs::path file = project.base / "project" / "outside.toml";
    const std::vector<std::string> known = {"../tetra.stl"};
    CHECK(pictures.of(outside, file, owner->folder(), {}, known) != nullptr);
    CHECK(pictures.of(secret, file, owner->folder(), {}, known) == nullptr);
    CHECK(pictures.of(outside, file, owner->folder(), {}) == nullptr);
}

TEST_CASE("a second robot is shown beside the first, and follows the same inputs") {
    const Project project;
    const auto owner = built(project);
    Studio& studio = *owner;
    CHECK(ask(studio, "GET", "/api/compare/scene").status == 404);
    CHECK(ask(studio, "POST", "/api/compare", R"({"name":"../outside.stl"})").status == 422);
    CHECK(ask(studio, "POST", "/api/compare", R"({"example":"no such"})").status == 422);
    REQUIRE(ask(studio, "POST", "/api/compare", "{}").status == 200);
    REQUIRE(studio.beside()->wait_until_built());
    // The first robot is made stiffer; the second one stays unchanged.
    std::string stiffer = project_bar;
    stiffer.replace(stiffer.find("1 MPa"), 5, "2 MPa");
    const auto page = joined(studio, "first_page");
    REQUIRE(ask(studio, "PUT", "/api/robot", stiffer, "first_page").status == 200);
    REQUIRE(studio.simulation().wait_until_built());
    CHECK(head_of(ask(studio, "GET", "/api/scene").body)["materials"][0]["youngs_modulus_MPa"] == 2);
    CHECK(head_of(ask(studio, "GET", "/api/compare/scene").body)["materials"][0]["youngs_modulus_MPa"] == 1);
    studio.receive(page,
                   R"({"type":"drive","tag":5,"actuators":[{"name":"flexor","kind":"shortening_mm","value":2}]})");
    Json first, second;
    while (first.is_null() || second.is_null()) {
        const auto out = page->next();
        REQUIRE(out);
        if (!out->binary) continue;
        const Json head = head_of(*out->bytes);
        if (head["tag"] != 5 || head["arrived"] != true) continue;
        (head.contains("beside") ? second : first) = head;
    }
    CHECK(first["cables"][0]["tension_N"].get<double>() ==
          near(2 * second["cables"][0]["tension_N"].get<double>(), {.relative = 1e-2}));
    CHECK(ask(studio, "POST", "/api/compare/leave", "", "first_page").status == 200);
    CHECK(studio.beside() == nullptr);
    CHECK(ask(studio, "GET", "/api/compare/frame").body.empty());
}

TEST_CASE("a file that is neither a robot nor a job is refused") {
    CHECK_FALSE(Studio::open({"no/such/robot.toml", "test"}));
    CHECK_FALSE(Studio::open({"no/such/job.zip", "test"}));
}

TEST_CASE("values and entries of the robot file change by request, and a text can be checked without building it") {
    const Project project;
    const auto studio = built(project);
    const auto page = joined(*studio, "somebody");
    const auto post = [&](const std::string& path, const std::string& body) {
        return studio->handle({"POST", path, {}, {}, "somebody", body});
    };
    CHECK(
        post(
            "/api/robot/set",
            R"({"changes": [{"key": "mesh.size", "value": "7 mm"}, {"key": "marker.tip.point", "value": [40, 5, 4.5]}]})")
            .status == 200);
    CHECK(studio->document().text.find("mesh = { size = \"7 mm\" }") != std::string::npos);
    CHECK(studio->document().text.find("point = [40, 5, 4.5]") != std::string::npos);
    CHECK(studio->document().undo.size() == 1);  // both are one step
    const Json whole = {{"text", project_bar}, {"changes", {{{"key", "program.duration"}, {"value", "2 s"}}}}};
    CHECK(post("/api/robot/set", whole.dump()).status == 200);
    CHECK(holds(studio->document().text, "mesh = { size = \"6 mm\""));
    CHECK(holds(studio->document().text, "duration = \"2 s\""));
    CHECK(studio->document().undo.size() == 2);
    CHECK(post("/api/robot/add", R"({"list": "marker", "entry": {"name": "middle", "point": [20, 5, 5]}})").status ==
          200);
    REQUIRE(studio->simulation().wait_until_built());
    CHECK(studio->simulation().built()->robot.markers.size() == 2);
    for (const auto& [path, body] :
         {std::pair{"/api/robot/set", "{}"},
          {"/api/robot/set", R"({"changes": []})"},
          {"/api/robot/set", R"({"changes": [{"key": "name"}]})"},
          {"/api/robot/set", R"({"changes": [{"key": "name", "value": null}]})"},
          {"/api/robot/set", R"({"changes": [{"key": "cable.nobody.friction", "value": 1}]})"},
          {"/api/robot/set", R"({"changes": [{"key": "cable[7].friction", "value": 1}]})"},
          {"/api/robot/add", R"({"list": "marker"})"},
          {"/api/robot/add", R"({"list": "name", "entry": {"a": 1}})"},
          {"/api/robot/set", R"({"changes": [{"key": "mesh.file", "value": "../../etc/passwd"}]})"}}) {
        INFO(body);
        CHECK(post(path, body).status == 422);
    }
    const std::string before = studio->document().text;
    std::string wrong = project_bar;
    wrong.replace(wrong.find("marker ="), 8, "markr =");
    const Json found = Json::parse(post("/api/robot/check", wrong).body);
    REQUIRE(found["lines"].size() == 1);
    CHECK(found["lines"][0]["line"] == 6);
    CHECK(Json::parse(post("/api/robot/check", project_bar).body)["lines"].empty());
    CHECK(studio->document().text == before);
    CHECK(Json::parse(studio->handle({"GET", "/api/materials"}).body).size() > 10);
    CHECK(post("/api/robot/new", project_bar).status == 200);
    CHECK(studio->document().name.empty());
}

TEST_CASE("changes of the robot that come at once are all made") {
    const Project project;
    const auto studio = opened(project);
    constexpr int many = 8;
    std::vector<std::thread> pages;
    for (int k = 0; k < many; ++k) {
        pages.emplace_back([&, k] {
            const std::string name = "m" + std::to_string(k);
            const Json added = {{"list", "marker"}, {"entry", {{"name", name}, {"point", Json::array({k, 5, 5})}}}};
            (void)ask(*studio, "POST", "/api/robot/add", added.dump());
            const Json change = {{"key", "marker." + name + ".point"}, {"value", Json::array({k, 6, 5})}};
            const Json set = {{"changes", Json::array({change})}};
            (void)ask(*studio, "POST", "/api/robot/set", set.dump());
        });
    }
    for (std::thread& page : pages) page.join();
    const std::string text = studio->document().text;
    for (int k = 0; k < many; ++k) CHECK(holds(text, "point = [" + std::to_string(k) + ", 6, 5]"));
    CHECK(studio->document().undo.size() == 2 * many);
}

TEST_CASE("a body with a key of another kind, or one that there is not, is refused by its name") {
    const Project project;
    const auto studio = opened(project);
    for (const auto& [path, body, why] :
         {std::tuple("/api/robot/save", R"({"name":5})", "name: a text is needed"),
          {"/api/robot/save", R"({"nam":"a"})", "nam: there is no such key; this request takes name and overwrite"},
          {"/api/robot/save", R"({"overwrite":"yes"})", "overwrite: true or false is needed"},
          {"/api/open", R"({"name":null})", "name: a text is needed"},
          {"/api/compare", R"({"name":5})", "name: a text is needed"},
          {"/api/print/twin", R"({"speed":"5"})", "speed: a number is needed"},
          {"/api/print/speed", "{}", "speed: a number is needed"},
          {"/api/print/speed", "", "speed: a number is needed"},
          {"/api/print/port", R"({"device":1})", "device: a text is needed"},
          {"/api/printer/measured", R"({"name":"tower","x_mm":"1"})", "x_mm: a number is needed"},
          {"/api/printer/pattern", R"({"square":"1"})", "square: a number is needed"},
          {"/api/job/save", R"({"name":["a"]})", "name: a text is needed"}}) {
        INFO(path, " ", body);
        const Response answer = ask(*studio, "POST", path, body);
        CHECK(answer.status == 422);
        CHECK(Json::parse(answer.body)["error"] == why);
    }
    CHECK(file_text(project.base / "project" / "bar.toml") == project_bar);
}

TEST_CASE("a job tells which robot text and which options it was sliced from, and pages know the present text") {
    const Project project;
    const auto studio = opened(project);
    const auto page = joined(*studio, "page_aaaa");
    const auto digest = [&] {
        for (;;) {
            const auto out = page->next();
            REQUIRE(out);
            if (out->binary) continue;
            const Json event = Json::parse(*out->bytes);
            if (event["type"] == "document") return event["digest"].get<std::string>();
        }
    };
    const std::string before = digest();
    const std::string order = R"({"printer":"tower","layer":"100 um","copies":1})";
    const auto slice = [&](const std::string& body) {
        const std::int64_t last = studio->make().job() ? studio->make().job()->revision : 0;
        REQUIRE(ask(*studio, "POST", "/api/job/slice", body, "page_aaaa").status == 200);
        while (!studio->make().job() || studio->make().job()->revision == last)
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        return Json::parse(ask(*studio, "GET", "/api/job").body)["source"];
    };
    const Json source = slice(order);
    CHECK(source["robot"] == before);
    CHECK(source["order"] == Json::parse(order));
    REQUIRE(studio->edit(std::string(project_bar) + "# longer").has_value());
    CHECK(digest() != before);
    REQUIRE(studio->undo().has_value());
    CHECK(digest() == before);
    REQUIRE(studio->open_file("bar.toml").has_value());
    CHECK(digest() == before);
    // Another file of geometry is another robot, although its text is the same.
    put_file(*studio, "part.stl", tetra_stl(), false, "page_aaaa");
    const std::string part =
        "name = \"part\"\n[mesh]\nsize = \"12 mm\"\n[material.m]\nyoungs_modulus = \"1 MPa\"\n"
        "poisson_ratio = 0.4\ndensity = \"1 g/cm^3\"\n[[body]]\nname = \"b\"\nmaterial = \"m\"\n"
        "geometry = { surface = \"part.stl\" }\n[[fixed]]\nname = \"f\"\nat = [0, 0, 0]\n";
    REQUIRE(studio->edit(part).has_value());
    const std::string with_part = digest();
    std::string other = tetra_stl();
    other.replace(other.find("30"), 2, "31.5");
    REQUIRE(put_file(*studio, "part.stl", other, true, "page_aaaa").status == 200);
    CHECK(digest() != with_part);
    REQUIRE(studio->undo().has_value());
    CHECK(digest() == before);
    // A robot of its own, as a wizard's, is not the one in the editor.
    CHECK(slice(Json{{"printer", "tower"}, {"layer", "100 um"}, {"robot", project_bar}}.dump()).is_null());
}

TEST_CASE("a robot that is in no file is called by what it came from") {
    const Project project;
    const auto studio = opened(project);
    const auto title = [&](const std::string& path) {
        const Response made = ask(*studio, "POST", path, project_bar);
        return made.status == 200 ? studio->document().title : made.body;
    };
    CHECK(title("/api/robot/new") == "new");
    Request dropped{"POST", "/api/robot/new", {{"name", "finger.toml"}}};
    dropped.body = project_bar;
    REQUIRE(studio->handle(dropped).status == 200);
    CHECK(studio->document().title == "finger.toml");
    CHECK(studio->document().name.empty());
    dropped.query["name"] = "../finger.toml";
    CHECK(studio->handle(dropped).status == 422);
    studio->open_example("cable_gripper");
    CHECK(studio->document().title == "example");
}

TEST_CASE("a body that is no JSON object is refused as such, by every request that takes one") {
    const auto studio = opened();
    for (const Route& route : studio->routes()) {
        if (route.takes != "application/json") continue;
        for (const char* body : {"{", "[]", "\"name\"", "{\"name\": }"}) {
            INFO(route.path, " ", body);
            const Response answer = ask(*studio, route.method, route.path, body);
            CHECK(answer.status == (route.path.starts_with("/api/print/host/") ? 400 : 422));
            CHECK(answer.body == R"({"error":"a JSON object is needed"})");
        }
    }
    CHECK(ask(*studio, "POST", "/api/open", "{}").body == R"({"error":"name: the name of a file is needed"})");
}

TEST_CASE("a number of a page that is not whole or too large is refused, and does not reach the machine") {
    const auto studio = opened();
    const auto shown = [&](const std::string& square) {
        return ask(*studio, "POST", "/api/printer/pattern",
                   R"({"name": "tower", "projector": "0", "pattern": "checkerboard", "seconds": 1, "square": )" +
                       square + "}")
            .body;
    };
    for (const char* square : {"1e300", "-1e300", "0", "1.5"}) {
        INFO(square);
        CHECK(shown(square) == R"({"error":"square: a whole number from 1 to 1000000 is needed"})");
    }
}
