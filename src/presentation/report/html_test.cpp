#include "presentation/report/html.hpp"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <regex>

#include "presentation/report/test_robot.hpp"

using namespace pliant;
using namespace pliant::report;

namespace {

/// The page without the plotting library.
std::string page(const Simulation& s) {
    std::string html = report_html(s, {{"final.png", "The <end>", "PNG bytes"}});
    const std::size_t begin = html.find("<script>");
    const std::size_t end = html.find("</script>", begin);
    REQUIRE(begin != std::string::npos);
    return html.erase(begin, end + 9 - begin);
}

}  // namespace

TEST_CASE("the page loads nothing from outside") {
    const auto robot = report::test::bent_bar(10, 1);
    const std::string html = report_html(robot.simulation(), {{"final.png", "At the end", "PNG bytes"}});
    const std::regex foreign(R"((src|href|action|data)\s*=\s*["']?\s*(https?:|//))", std::regex::icase);
    CHECK_FALSE(std::regex_search(page(robot.simulation()), foreign));
    CHECK(html.find("src=\"http") == std::string::npos);
    CHECK(html.find("href=\"http") == std::string::npos);
    CHECK(html.find("@import") == std::string::npos);
    CHECK(html.find("sourceMappingURL") == std::string::npos);
    CHECK(html.find("default-src 'none'") != std::string::npos);
    CHECK(html.find("src=\"data:image/png;base64,UE5HIGJ5dGVz\"") != std::string::npos);
    CHECK(html.find("Dygraph") != std::string::npos);
    CHECK(html.find("MIT") != std::string::npos);
}

TEST_CASE("contact has a table with the largest force over all steps") {
    auto robot = report::test::bent_bar(2, 1);
    CHECK(page(robot.simulation()).find("<h2>Contact</h2>") == std::string::npos);
    for (auto& step : robot.result.steps) step.contacts = {{"a <ball>", {0, 0, step.index == 1 ? -7.0 : -2.5}}};
    robot.result.steps[1].smallest_distance_m = 4e-5;
    const std::string html = page(robot.simulation());
    CHECK(html.find("<td>a &lt;ball&gt;</td><td>(0, 0, -2.5)</td><td>2.5</td><td>7</td>") != std::string::npos);
    CHECK(html.find("as near as 0.04 mm") != std::string::npos);
}

TEST_CASE("iterations are in the page if there are any") {
    auto robot = report::test::bent_bar(2, 1);
    robot.result.iterations.clear();
    CHECK(page(robot.simulation()).find("id=\"iterations\"") == std::string::npos);
    robot.result.iterations = {{.step = 1, .solver = sim::Solver::anderson, .residual = 0.5}};
    CHECK(
        page(robot.simulation()).find("id=\"iterations\">{\"solvers\":[\"anderson\"],\"rows\":[[0,0,0.5]]}</script>") !=
        std::string::npos);
}

TEST_CASE("names from a robot file are escaped in the page") {
    const std::string evil = "</script><script>alert(1)</script>\"'&";
    auto robot = report::test::bent_bar(2, 1);
    for (auto& step : robot.result.steps) {
        step.cables[0].name = evil;
        step.markers[0].name = evil;
        step.supports[0].name = evil;
        step.contacts = {{evil, {}}};
    }
    robot.result.message = evil;
    robot.result.warnings = {evil};
    Simulation s = robot.simulation();
    s.robot = evil;
    s.materials[0].name = s.materials[0].law = s.materials[0].resin = evil;
    s.settings = {{evil, evil}};
    const std::string html = page(s);
    CHECK(html.find("<script>alert") == std::string::npos);
    CHECK(html.find("&lt;/script&gt;&lt;script&gt;alert(1)") != std::string::npos);
    std::size_t scripts = 0;
    for (std::size_t at = 0; (at = html.find("<script", at)) != std::string::npos; ++at) ++scripts;
    CHECK(scripts == 3);  // the data, the iterations and the page's own code; the library was taken out
}

TEST_CASE("the data in the page are those of summary.json") {
    const auto robot = report::test::bent_bar(10, 1);
    const std::string html = page(robot.simulation());
    const std::string open = "<script type=\"application/json\" id=\"data\">";
    const std::size_t begin = html.find(open) + open.size();
    const auto j = nlohmann::json::parse(html.substr(begin, html.find("</script>", begin) - begin));
    CHECK(j["steps"].size() == 10);
    CHECK(j["steps"][9]["cables"]["flexor"]["tension_N"] == 71);
}

TEST_CASE("tables show volumes, masses and actuators") {
    const auto robot = report::test::bent_bar(10, 1);
    const std::string html = page(robot.simulation());
    CHECK(html.find("<td>18 cm³</td><td>18.72 g</td>") != std::string::npos);
    CHECK(html.find("<td>flexor</td><td>cable</td><td>120.00 mm</td>") != std::string::npos);
    CHECK(html.find("stopped early") == std::string::npos);
    CHECK(html.find("1,440 linear tets") != std::string::npos);
}

TEST_CASE("HTML and JSON in scripts are escaped") {
    CHECK(html_escaped("a<b>&\"'\n") == "a&lt;b&gt;&amp;&quot;&#39; ");
    CHECK(html_escaped("\xc3\xa4\xff") == "\xc3\xa4\xef\xbf\xbd");
    CHECK(script_safe_json("\"</a>&\xe2\x80\xa8\"") == "\"\\u003c/a\\u003e\\u0026\\u2028\"");
}
