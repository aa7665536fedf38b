// Input files of commands. A file of the wrong kind is reported in one line that says what it is; a printer may also be
// a built-in one, by name.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/files.hpp"
#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"
#include "printing/operate/job_file.hpp"
#include "printing/operate/proved_job.hpp"
#include "robot/description/robot.hpp"

namespace pliant::app {

enum class FileKind { unknown, robot, printer, study, job, geometry };

/// Recognised by content: a TOML file has keys that only robots, only printers or only studies have; a zip file is a
/// job if it has a manifest. `geometry`: 3MF, STL, OBJ, PLY, STEP and mesh files, by name.
[[nodiscard]] FileKind kind_of(const std::filesystem::path& file);

/// Rejects a file that is certainly of another kind.
[[nodiscard]] Status expect(FileKind needed, const std::string& file);

struct PrinterText {
    machine::Printer printer;
    std::string text;
};

/// A printer file, or the built-in one of that name if there is no such file. Errors: those of machine::load_printer,
/// or the name is neither.
[[nodiscard]] Result<PrinterText> read_printer_file(const std::string& name);
[[nodiscard]] Result<machine::Printer> read_printer(const std::string& name);

/// Errors: those of robot::load_robot; another kind of file.
[[nodiscard]] Result<robot::Robot> read_robot(const std::string& file, const std::vector<std::string>& assignments);

/// As check_folder_place(); and neither a file that this robot is read from nor `measured`, if any, may lie in the
/// folder. An empty name of a folder passes.
[[nodiscard]] Status check_results_place(const std::string& folder, const FolderMark& mark, const std::string& robot,
                                         const std::vector<std::string>& assignments, const std::string& measured = "");

/// For `--set` with a file that is no robot file.
[[nodiscard]] tl::unexpected<Error> no_assignments(const std::string& file);

/// Errors: those of operate::open_job; another kind of file.
[[nodiscard]] Result<operate::OpenJob> read_job(const std::string& file);
/// Errors: those of operate::prove_job; another kind of file.
[[nodiscard]] Result<operate::ProvedJob> prove_job(const std::string& file,
                                                   operate::Pixels pixels = operate::Pixels::fingerprints,
                                                   const machine::Printer* other = nullptr);
[[nodiscard]] Result<job::Archive> read_archive(const std::string& file);

/// Rejects an output file whose extension does not fit its content, as in `-o part.stl: a job ends in .zip: part.zip`.
/// Empty names pass.
[[nodiscard]] Status check_ending(std::string_view option, const std::string& file, std::string_view what,
                                  std::string_view ending);

}  // namespace pliant::app
