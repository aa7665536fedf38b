// A part of a workspace as a search stores it: what is accepted is written and read back.
#include <cstdlib>

#include "input.hpp"
#include "simulation/inverse/workspace_record.hpp"
#include "simulation/stepper/cbor_numbers.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace pliant::sim::inverse;
    const auto piece = piece_from_bytes(pliant::sim::cbor::sealed(std::string(as_text(data, size))), "");
    if (piece && piece_from_bytes(piece_bytes(*piece, ""), "")->samples.size() != piece->samples.size()) std::abort();
    return 0;
}
