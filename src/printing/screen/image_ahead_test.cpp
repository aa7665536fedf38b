#include "printing/screen/image_ahead.hpp"

#include <doctest/doctest.h>

#include <atomic>

using namespace pliant;
using namespace pliant::host;

namespace {

/// Records requests, and whether two were concurrent.
struct Source {
    std::atomic<int> inside = 0;
    std::atomic<bool> together = false;
    std::vector<std::pair<int, int>> asked;

    Result<job::Image> fetch(int layer, int material) {
        if (++inside > 1) together = true;
        asked.emplace_back(layer, material);
        --inside;
        if (layer == 9) return failure("layer 9 is damaged");
        return job::Image{1, 1, {static_cast<std::uint8_t>(10 * layer + material)}};
    }
    ImageAhead::Source function() {
        return [this](int layer, int material) { return fetch(layer, material); };
    }
};

}  // namespace

TEST_CASE("the next image is ready when it is requested, and every image is fetched once") {
    Source source;
    const ImageAhead::Order order = {{0, 0}, {0, 1}, {1, 1}, {1, 0}, {9, 0}, {2, 0}};
    {
        ImageAhead ahead(source.function(), order);
        for (const auto& [layer, material] : order) {
            const auto image = ahead.get(layer, material);
            CHECK(image.has_value() == (layer != 9));
            if (image) CHECK(image->pixels[0] == 10 * layer + material);
        }
        CHECK(ahead.fetched_ahead() == 6);
    }
    CHECK(source.asked == order);
    CHECK_FALSE(source.together);
}

TEST_CASE("images requested in another order are the same") {
    Source source;
    ImageAhead ahead(source.function(), {{0, 0}, {1, 0}, {2, 0}, {3, 0}});
    for (const int layer : {2, 3, 0, 5, 1, 2, 2}) CHECK(ahead.get(layer, 0)->pixels[0] == 10 * layer);
    CHECK(ahead.fetched_ahead() == 2);  // 3 after 2, and the second 2 after 1
    CHECK_FALSE(source.together);
}

TEST_CASE("the order of images is that of the G-code") {
    const auto order = order_of_exposures(
        "G28 Z\n;@expose layer=0 material=1 seconds=2.5 image=a.png\n; a comment\n;@stop M107 P1\n;@expose broken\n"
        ";@expose layer=1 material=0 seconds=2.5 image=b.png");
    CHECK(order == ImageAhead::Order{{0, 1}, {1, 0}});
}
