// Printer files of the project folder, made from a built-in one and changed value by value: what a wizard writes.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/core/error.hpp"
#include "presentation/studio/project_folder.hpp"
#include "printing/machine/printer.hpp"
#include "printing/prepare/slice_job.hpp"

namespace pliant::studio {

/// Built-in ("tower") or of the folder ("mine.toml"), with its mask, which must lie in the folder too. Errors: there is
/// none, what is wrong with it.
[[nodiscard]] Result<prepare::PrinterFile> read_printer(const ProjectFolder& folder, const std::string& name);

/// A printer file of that name with the text of another. Errors: the name does not end with .toml, exists, leads out of
/// the folder; no such printer.
[[nodiscard]] Status new_printer(const ProjectFolder& folder, const std::string& from, const std::string& name);

/// Keys as of config::with_value(), values in TOML.
using PrinterChanges = std::vector<std::pair<std::string, std::string>>;
/// Changes values where they stand, with comments and order kept, and writes the file. Errors, and then nothing is
/// written: a built-in printer, what toml_edit refuses, a printer that would be wrong with them.
[[nodiscard]] Status change_printer(const ProjectFolder& folder, const std::string& name,
                                    const PrinterChanges& changes);

/// What a page sets up: its axes, store, vats, resins, projector, port, switches, as JSON.
[[nodiscard]] std::string printer_setup_json(const std::string& name, const machine::Printer& printer, bool built_in);

/// Printers to begin with: [{"name", "title", "store", "slots", "vats", "size_mm", "pixel_um", "dialect"}].
[[nodiscard]] std::string built_in_printers_json();

/// What a board has answered, against the machine that it is to drive: {"firmware", "capabilities", "switches",
/// "problems"}.
[[nodiscard]] std::string board_json(const std::string& answers, const machine::Printer& printer);

}  // namespace pliant::studio
