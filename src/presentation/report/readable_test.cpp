// Numbers of a summary.
#include "presentation/report/readable.hpp"

#include <doctest/doctest.h>

#include <array>

using pliant::report::readable;

TEST_CASE("usual numbers have their decimals; very small and very large ones five digits") {
    CHECK(readable(12.3456, 2) == "12.35");
    CHECK(readable(0, 3) == "0.000");
    CHECK(readable(0.0006, 3) == "0.001");
    CHECK(readable(1.23456e-6, 3) == "1.2346e-06");
    CHECK(readable(-1.23456e34, 1) == "-1.2346e+34");
    CHECK(readable(9999999.4, 1) == "9999999.4");
    CHECK(readable(std::array{4.0005, -0.00002, 0.2788}, 4) == "4.0005, 0.0000, 0.2788");
    CHECK(readable(std::array{3e-15, -1e-16}, 4) == "0.0000, 0.0000");
    CHECK(readable(3e-7, 4, 1e-6) == "0.0000");
    CHECK(readable(-3e-7, 4, 1e-6) == "0.0000");
    CHECK(readable(-0.00006, 4) == "-0.0001");
    CHECK(readable(-0.0, 0) == "0");
    CHECK(readable(std::array{4e-6, 2.5e-7, 1e-15}, 3) == "4e-06, 2.5e-07, 0");
}
