/// @file
/// The whole public interface of Pliant.
#pragma once

#include "pliant/base.hpp"           // IWYU pragma: export
#include "pliant/batch.hpp"          // IWYU pragma: export
#include "pliant/gradient.hpp"       // IWYU pragma: export
#include "pliant/identify.hpp"       // IWYU pragma: export
#include "pliant/inverse.hpp"        // IWYU pragma: export
#include "pliant/linearisation.hpp"  // IWYU pragma: export
#include "pliant/printing.hpp"       // IWYU pragma: export
#include "pliant/program.hpp"        // IWYU pragma: export
#include "pliant/reduced.hpp"        // IWYU pragma: export
#include "pliant/simulation.hpp"     // IWYU pragma: export
#include "pliant/view.hpp"           // IWYU pragma: export
#include "pliant/workspace.hpp"      // IWYU pragma: export
