// The cured layers of the virtual printer as voxels.
#pragma once

#include <vector>

#include "pliant/printing.hpp"
#include "printing/machine/printer.hpp"
#include "printing/twin/cure.hpp"

namespace pliant::library {

/// Throws if the block has too many voxels.
[[nodiscard]] CuredBlock cured_block(const std::vector<twin::CuredLayer>& layers, const machine::Printer& printer);

}  // namespace pliant::library
