// Printer files of the project folder, created from a built-in one and changed value by value by the setup wizard.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/core/error.hpp"
#include "printing/machine/printer.hpp"
#include "printing/prepare/slice_job.hpp"
#include "studio/requests/project_folder.hpp"

namespace pliant::studio {

/// How a machine keeps its vats, as the pages name it: "tower", "wall", "table" or "none".
[[nodiscard]] std::string_view store_name(machine::Store store);

/// A built-in printer ("tower") or one of the folder ("mine.toml"), with its mask, which must be in the folder too.
/// Errors: it does not exist, or is invalid.
[[nodiscard]] Result<prepare::PrinterFile> read_printer(const ProjectFolder& folder, const std::string& name);

/// Creates a printer file of that name with the text of another. Errors: the name does not end with .toml, exists,
/// leads out of the folder; no such printer.
[[nodiscard]] Status new_printer(const ProjectFolder& folder, const std::string& from, const std::string& name);

/// Keys as of config::with_value(), values in TOML.
using PrinterChanges = std::vector<std::pair<std::string, std::string>>;
/// Changes values in place, keeping comments and order, and writes the file. Errors, in which case nothing is written:
/// a built-in printer, a change that toml_edit refuses, a printer that would become invalid.
[[nodiscard]] Status change_printer(const ProjectFolder& folder, const std::string& name,
                                    const PrinterChanges& changes);

/// The settings of a printer in the wizard: axes, store, vats, resins, projector, port, switches, as JSON.
[[nodiscard]] std::string printer_setup_json(const std::string& name, const machine::Printer& printer, bool built_in);

/// Printers to start from: [{"name", "title", "store", "slots", "vats", "size_mm", "pixel_um", "dialect"}].
[[nodiscard]] std::string built_in_printers_json();

/// A board's answers compared with the machine that it should drive: {"firmware", "capabilities", "switches",
/// "problems"}.
[[nodiscard]] std::string board_json(const std::string& answers, const machine::Printer& printer);

}  // namespace pliant::studio
