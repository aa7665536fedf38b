// A print under control against the virtual printer, in one thread and on its clock: pauses, changes, cancelling, and
// resuming after every way to end.
#include <doctest/doctest.h>

#include "control_bench.hpp"

using namespace pliant;
using namespace pliant::app;

TEST_CASE("a print under control comes out as the plain one, and keeps a journal") {
    ControlBench b;
    b.start();
    CHECK(b.snapshot().finished);
    INFO(b.last_error());
    b.must_be_whole();
    CHECK(b.lights() == 10);
}
