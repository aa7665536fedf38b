// Tables of tensile tests, and the fit to their content.
#include "input.hpp"
#include "simulation/calibrate/fit.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace pliant::calibrate;
    const auto test = parse_tensile_csv(as_text(data, size), "fuzz.csv");
    if (test && test->stretch.size() < 64) (void)fit(*test, {FitLaw::yeoh, 1, 0.49});
    return 0;
}
