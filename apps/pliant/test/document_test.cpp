#include "document.hpp"

#include <doctest/doctest.h>

using namespace pliant;
using namespace pliant::app;

namespace {

const char* const page =
    "Text with `pliant` in it.\n"
    "<!-- run: save a.toml -->\n"
    "```toml\nname = \"a\"\nsteps = 5\n[[load]]\nforce = 1\n\n[program]\nx = 1\n```\n"
    "<!-- run: replace [[load]] in a.toml -->\n"
    "```toml\n[[cable]]\nlength = 2\n```\n"
    "<!-- run: insert before [program] in a.toml -->\n"
    "```toml\n[mesh]\n```\n"
    "<!-- run: replace steps = in a.toml -->\n"
    "```toml\nsteps = 20\n```\n"
    "    pliant mesh ROBOT.toml -o FILE [options]\n"
    "    pliant simulate a.toml --set mesh.order=1\n"
    "<!-- run: not it takes a day -->\n"
    "```\n$ pliant study\n```\n"
    "<!-- run: any 2 -->\n"
    "```\n$ pliant simulate a.toml\n20 steps in 2.22 s, residual 4.5e-05, det F 0.858\n\n$ pliant plan\n...\ntime "
    "5:41:58\n```\n";

DocumentStep showing(std::vector<std::string> lines) {
    DocumentStep step;
    step.shows_output = true;
    step.output = std::move(lines);
    return step;
}

}  // namespace

TEST_CASE("commands, blocks and comments of a document are found in order") {
    const auto steps = document_steps(page);
    REQUIRE_MESSAGE(steps.has_value(), (steps ? "" : steps.error().message));
    REQUIRE(steps->size() == 8);
    CHECK((*steps)[4].text == "pliant simulate a.toml --set mesh.order=1");
    CHECK(!(*steps)[4].shows_output);
    CHECK((*steps)[5].kind == DocumentStep::Kind::skipped);
    CHECK((*steps)[5].reason == "it takes a day");
    CHECK((*steps)[6].output == std::vector<std::string>{"20 steps in 2.22 s, residual 4.5e-05, det F 0.858"});
    CHECK((*steps)[6].any == std::set<int>{2});
    CHECK((*steps)[7].text == "pliant plan");
    CHECK(!document_steps("<!-- run: dance -->\n"));
    CHECK(!document_steps("<!-- run: not because -->\nThe end.\n"));
}

TEST_CASE("the edits that a document shows are made to the file") {
    const auto steps = document_steps(page);
    REQUIRE(steps.has_value());
    std::string file;
    for (std::size_t i = 0; i < 4; ++i) file = edited(file, (*steps)[i]).value();
    CHECK(file == "name = \"a\"\nsteps = 20\n[[cable]]\nlength = 2\n\n[mesh]\n\n[program]\nx = 1\n");
    CHECK(!edited("nothing", (*steps)[1]));
}

TEST_CASE("printed output must equal the document, except for times, residuals and last digits") {
    const DocumentStep step =
        showing({"20 steps in 2.22 s, residual 4.5e-05, det F 0.858", "tip: (54.257, -0.0000) mm"});
    const auto with = [&](const char* first, const char* second) { return difference(step, {first, second}); };
    CHECK(with("20 steps in 17.9 s, residual 1.0e-07, det F 0.859", "tip: (54.258,   0.0001) mm").empty());
    CHECK(!with("20 steps in 2.22 s, residual 4.5e-05, det F 0.864", "tip: (54.257, -0.0000) mm").empty());
    CHECK(!with("20 steps in 2.22 s, residual 4.5e-05, det F 0.858", "tip: (54.6, 0.0000) mm").empty());
    CHECK(!with("20 steps in 2.22 s, residual 4.5e-05, det J 0.858", "tip: (54.257, -0.0000) mm").empty());
    CHECK(!difference(step, {step.output[0]}).empty());
    CHECK(!difference(step, {step.output[0], step.output[1], "more"}).empty());
    CHECK(!difference(showing({"time 5:41:58"}), {"time 5:51:58"}).empty());
    CHECK(difference(showing({"time 5:41:58"}), {"time 5:42:01"}).empty());
    const DocumentStep gap = showing({"...", "last 3"});
    CHECK(difference(gap, {"a", "b 2", "last 3"}).empty());
    CHECK(!difference(gap, {"a", "b 2", "last 40"}).empty());
}

TEST_CASE("updating a document writes the new output, but keeps lines that are left out (\"...\")") {
    const auto steps = document_steps(page);
    REQUIRE(steps.has_value());
    std::vector<std::vector<std::string>> printed(steps->size());
    printed[6] = {"new", "lines"};
    printed[7] = {"other"};
    const std::string made = updated(page, *steps, printed);
    CHECK(made.find("$ pliant simulate a.toml\nnew\nlines\n\n$ pliant plan\n...\n") != std::string::npos);
}
