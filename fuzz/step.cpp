// STEP files. Open CASCADE, which parses them, is built without sanitizers: this finds only crashes and hangs of the
// program.
#include "file.hpp"
#include "geometry/mesher/step_file.hpp"
#include "input.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const TemporaryFile file(as_text(data, size), ".step");
    (void)pliant::mesh::read_step(file.path(), "", 1);
    return 0;
}
