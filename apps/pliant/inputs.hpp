// The files that commands are given. One of another kind than is needed is named for what it is, in one line; a
// printer may be one of those that are built in, by name.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"
#include "printing/operate/job_file.hpp"
#include "printing/operate/proved_job.hpp"
#include "robot/description/robot.hpp"

namespace pliant::app {

enum class FileKind { unknown, robot, printer, job, geometry };

/// By content: a TOML file has keys that only robots, or only printers, have; a zip file is a job where it has a
/// manifest. `geometry`: 3MF, STL, OBJ, PLY, STEP and mesh files, by name.
[[nodiscard]] FileKind kind_of(const std::filesystem::path& file);

/// Refuses a file that is certainly of another kind.
[[nodiscard]] Status expect(FileKind needed, const std::string& file);

struct PrinterText {
    machine::Printer printer;
    std::string text;
};

/// A printer file, or the built-in one of that name where there is no such file. Errors: as machine::load_printer, a
/// name that is neither.
[[nodiscard]] Result<PrinterText> read_printer_file(const std::string& name);
[[nodiscard]] Result<machine::Printer> read_printer(const std::string& name);

/// Errors: as robot::load_robot; another kind of file.
[[nodiscard]] Result<robot::Robot> read_robot(const std::string& file, const std::vector<std::string>& assignments);

/// Errors: as operate::open_job; another kind of file.
[[nodiscard]] Result<operate::OpenJob> read_job(const std::string& file);
/// Errors: as operate::prove_job; another kind of file.
[[nodiscard]] Result<operate::ProvedJob> prove_job(const std::string& file,
                                                   operate::Pixels pixels = operate::Pixels::fingerprints,
                                                   const machine::Printer* other = nullptr);
[[nodiscard]] Result<job::Archive> read_archive(const std::string& file);

/// Refuses a file to be written whose name ends otherwise than what is written into it, as in
/// `-o part.stl: a job ends in .zip: part.zip`. Empty names pass.
[[nodiscard]] Status check_ending(std::string_view option, const std::string& file, std::string_view what,
                                  std::string_view ending);

}  // namespace pliant::app
