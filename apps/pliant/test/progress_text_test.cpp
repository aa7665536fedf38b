#include "../progress_text.hpp"

#include <doctest/doctest.h>

using namespace pliant::app;

TEST_CASE("a progress bar shows the remaining time as soon as it can be estimated") {
    CHECK(progress_line("mesh", 0.5, 1) == "     mesh [===============               ]  50 %");
    CHECK(progress_line("simulate", 0.25, 10) == " simulate [=======                       ]  25 %, about 30 s left");
    CHECK(progress_line("simulate", 0.01, 10) == " simulate [                              ]   1 %");
    CHECK(progress_line("simulate", 0.1, 60) == " simulate [===                           ]  10 %, about 9 min left");
    CHECK(progress_line("simulate", 1.5, 60) == " simulate [==============================] 100 %");
    CHECK(progress_line("simulate", -1, 60) == " simulate [                              ]   0 %");
}
