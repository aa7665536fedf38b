// The printers of examples/printers, compiled into the program: wherever a printer file is asked for, their name does.
#pragma once

#include <span>
#include <string>

#include "base/core/embedded_file.hpp"
#include "base/core/error.hpp"

namespace pliant::machine {

/// By name.
[[nodiscard]] std::span<const EmbeddedFile> built_in_printers();

/// True for a word without dots and slashes that is not the name of a file in the current folder: it can only be
/// meant as the name of a built-in printer.
[[nodiscard]] bool is_printer_name(const std::string& word);

/// True if `word` means a built-in printer.
[[nodiscard]] bool is_built_in_printer(const std::string& word);

/// The text of a built-in printer, or that of the printer file `name`. Errors: there is neither, with the nearest name;
/// the file cannot be read.
[[nodiscard]] Result<std::string> read_printer_text(const std::string& name);

}  // namespace pliant::machine
