#include "studio/server/help_pages.hpp"

#include <doctest/doctest.h>

#include <filesystem>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"

using namespace pliant;
using namespace pliant::studio;

namespace {

/// An installation: bin, and pages below share.
struct Installation {
    pliant::test::Folder root{"help"};
    Installation() {
        std::filesystem::create_directories(root / "bin");
        std::filesystem::create_directories(root / "share/doc/pliant/html/reference");
        REQUIRE(write_file(root / "share/doc/pliant/html/index.html", "first"));
        REQUIRE(write_file(root / "share/doc/pliant/html/reference/robot.html", "keys"));
        REQUIRE(write_file(root / "share/doc/pliant/html/style.css", "css"));
        REQUIRE(write_file(root / "share/doc/pliant/html/robot.toml", "name"));
        REQUIRE(write_file(root / "share/doc/pliant/html/notes.cgi", "no"));
        REQUIRE(write_file(root / "share/doc/pliant/secret.html", "outside"));
        std::filesystem::create_symlink("../../../../bin/shared.js", root / "share/doc/pliant/html/shared.js");
        REQUIRE(write_file(root / "bin/shared.js", "js"));
    }
};

}  // namespace

TEST_CASE("the help pages are found from the program's folder, and served with their types") {
    const Installation there;
    const auto folder = find_help_pages(there.root / "bin");
    REQUIRE(!folder.empty());
    CHECK(std::filesystem::equivalent(folder, there.root / "share/doc/pliant/html"));
    CHECK(help_page(folder, "/help/").body == "first");
    CHECK(help_page(folder, "/help/index.html").type == "text/html; charset=utf-8");
    CHECK(help_page(folder, "/help/reference/robot.html").body == "keys");
    CHECK(help_page(folder, "/help/style.css").type == "text/css; charset=utf-8");
    CHECK(help_page(folder, "/help/shared.js").body == "js");
    CHECK(help_page(folder, "/help/robot.toml").type == "text/plain; charset=utf-8");
    CHECK(help_page(folder, "/help").status == 302);
    CHECK(help_page(folder, "/help").location == "/help/");
}

TEST_CASE("nothing outside the help folder is served") {
    const Installation there;
    const auto folder = find_help_pages(there.root / "bin");
    for (const char* path : {"/help/../secret.html", "/help/reference/../../secret.html", "/help//etc/passwd",
                             "/help/./index.html", "/help/..\\secret.html", "/help/reference", "/help/reference/",
                             "/help/none.html", "/help/notes.cgi", "/helpless/index.html", "/help/index.html/"}) {
        CAPTURE(path);
        CHECK(help_page(folder, path).status == 404);
    }
    CHECK(help_page(folder, std::string_view("/help/index\0.html", 17)).status == 404);
}

TEST_CASE("without help pages the answer names the package to install") {
    const Response response = help_page({}, "/help/");
    CHECK(response.status == 404);
    CHECK(response.body.find("pliant-doc") != std::string::npos);
}
