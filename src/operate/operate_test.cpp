#include <doctest/doctest.h>

#include <filesystem>

#include "core/files.hpp"
#include "core/test_folder.hpp"
#include "job/png.hpp"
#include "operate/layer_command.hpp"
#include "operate/picture_projector.hpp"

using namespace pliant;
using namespace pliant::operate;

TEST_CASE("a folder shows the picture as long as there is light") {
    const pliant::test::Folder folder;
    {
        PictureProjector projector(folder.path());
        REQUIRE(projector.black());
        REQUIRE(projector.show({2, 1, {0, 200}}));
        const auto image = job::decode_png(read_file(projector.shown()).value(), {2, 1}, "shown").value();
        CHECK(image.pixels == std::vector<std::uint8_t>{0, 200});
        REQUIRE(projector.black());
        CHECK_FALSE(std::filesystem::exists(projector.shown()));
        REQUIRE(projector.show({2, 1, {0, 200}}));
    }
    CHECK(std::filesystem::is_empty(folder.path()));
    PictureProjector nowhere(folder.path() / "none");
    CHECK_FALSE(nowhere.show({2, 1, {0, 200}}));
}

TEST_CASE("the command after a layer knows the layer; one that fails or hangs is reported") {
    const pliant::test::Folder folder;
    const std::string file = (folder.path() / "layer").string();
    CHECK(run_layer_command("echo -n $PLIANT_LAYER > " + file, 12));
    CHECK(read_file(file).value() == "12");
    CHECK_FALSE(run_layer_command("exit 3", 0));
    CHECK(run_layer_command("sleep 60", 0, 0.05).error().message.find("took over") != std::string::npos);
}
