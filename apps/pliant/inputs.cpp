#include "inputs.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <functional>
#include <utility>

#include "base/core/config.hpp"
#include "base/core/files.hpp"
#include "base/core/text.hpp"
#include "geometry/open/open_geometry.hpp"
#include "printing/machine/built_in_printers.hpp"
#include "robot/file/robot_document.hpp"
#include "robot/file/robot_file.hpp"

namespace pliant::app {
namespace {

namespace fs = std::filesystem;

template <std::size_t N>
bool one_of(std::string_view word, const std::array<std::string_view, N>& words) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

/// `parameters`, `name` and `material` are not used: both kinds may have the first two, a typing error the last.
FileKind kind_of_toml(const fs::path& file) {
    constexpr std::array<std::string_view, 10> of_printers{"axis",  "projector", "vat",      "tower",    "vat_shape",
                                                           "resin", "cleaning",  "carriage", "platform", "table"};
    constexpr std::array<std::string_view, 9> of_robots{"body",   "mesh",    "fixed", "cable",   "chamber",
                                                        "marker", "program", "load",  "material"};
    constexpr std::array<std::string_view, 6> of_studies{"command", "plan", "key", "result", "samples", "slurm"};
    const Result<config::Document> document = config::load(file);
    if (!document) return FileKind::unknown;
    std::array<std::pair<int, FileKind>, 3> kinds{{{0, FileKind::printer}, {0, FileKind::robot}, {0, FileKind::study}}};
    for (const auto& [key, value] : std::get<config::Table>(document->root.data)) {
        kinds[0].first += one_of(key, of_printers) ? 1 : 0;
        kinds[1].first += one_of(key, of_robots) ? 1 : 0;
        kinds[2].first += one_of(key, of_studies) ? 1 : 0;
    }
    std::ranges::sort(kinds, std::greater{}, [](const auto& kind) { return kind.first; });
    return kinds[0].first > kinds[1].first ? kinds[0].second : FileKind::unknown;
}

bool is_zip(const fs::path& file) {
    std::array<char, 2> head{};
    std::ifstream(file, std::ios::binary).read(head.data(), head.size());
    return head == std::array<char, 2>{'P', 'K'};
}

/// For a name whose ending says nothing, or another thing than what is in the file.
FileKind kind_by_content(const fs::path& file) {
    if (is_zip(file)) return FileKind::unknown;  // a damaged job: its own message says more
    if (const FileKind kind = kind_of_toml(file); kind != FileKind::unknown) return kind;
    return mesh::open_geometry(file) ? FileKind::geometry : FileKind::unknown;
}

/// "an STL file", by its file extension.
std::string_view geometry_name(const std::string& file) {
    constexpr std::array<std::pair<std::string_view, std::string_view>, 12> names{{{".stl", "an STL file"},
                                                                                   {".obj", "an OBJ file"},
                                                                                   {".ply", "a PLY file"},
                                                                                   {".off", "an OFF file"},
                                                                                   {".3mf", "a 3MF file"},
                                                                                   {".step", "a STEP file"},
                                                                                   {".stp", "a STEP file"},
                                                                                   {".vtk", "a VTK mesh"},
                                                                                   {".vtu", "a VTU mesh"},
                                                                                   {".msh", "a Gmsh mesh"},
                                                                                   {".mesh", "a Medit mesh"},
                                                                                   {".inp", "a CalculiX mesh"}}};
    const std::string extension = lower_extension(file);
    for (const auto& [ending, name] : names) {
        if (ending == extension) return name;
    }
    return "geometry";
}

/// Describes what the file is, and how to convert it to what is needed.
std::string text_of(FileKind kind, const std::string& file, FileKind needed) {
    const std::string stem = fs::path(file).stem().string();
    const std::string_view what = kind == FileKind::robot     ? "a robot file"
                                  : kind == FileKind::printer ? "a printer file"
                                  : kind == FileKind::study   ? "a study file"
                                  : kind == FileKind::job     ? "a job"
                                                              : geometry_name(file);
    if (needed == FileKind::study) return fmt::format("{}: is {}; a study file is needed here", file, what);
    if (needed == FileKind::printer) {
        return fmt::format("{}: is {}; a printer file is needed here, or the name of a built-in one, such as tower",
                           file, what);
    }
    if (needed == FileKind::robot) {
        if (kind == FileKind::printer || kind == FileKind::study)
            return fmt::format("{}: is {}; a robot file is needed here", file, what);
        if (kind == FileKind::job)
            return fmt::format("{}: is a job; a robot file is needed here, such as the one that it was sliced from",
                               file);
        return fmt::format("{}: is {}; a robot file is needed here, in which a body names it (pliant new writes one)",
                           file, geometry_name(file));
    }
    if (kind == FileKind::printer)
        return fmt::format("{}: is a printer file; a job is needed here, which pliant slice makes with --printer {}",
                           file, file);
    if (kind == FileKind::study) return fmt::format("{}: is a study file; a job is needed here", file);
    if (kind == FileKind::robot && lower_extension(file) != ".toml")
        return fmt::format("{}: is a robot file; a job is needed here: rename it to {}.toml and slice it", file, stem);
    if (kind == FileKind::robot)
        return fmt::format(
            "{}: is a robot file; a job is needed here: pliant slice {} --printer PRINTER.toml -o {}.zip", file, file,
            stem);
    return fmt::format("{}: is {}; a job is needed here: pliant slice MATERIAL={} --printer PRINTER.toml -o {}.zip",
                       file, geometry_name(file), file, stem);
}

}  // namespace

FileKind kind_of(const fs::path& file) {
    constexpr std::array<std::string_view, 12> geometry{".stl", ".obj", ".ply", ".3mf",  ".step", ".stp",
                                                        ".vtk", ".vtu", ".msh", ".mesh", ".off",  ".inp"};
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored)) return FileKind::unknown;
    const std::string extension = lower_extension(file);
    if (extension == ".toml") return kind_of_toml(file);
    if (one_of(extension, geometry)) return FileKind::geometry;
    return job::Archive::open(file) ? FileKind::job : kind_by_content(file);
}

Status expect(FileKind needed, const std::string& file) {
    const FileKind kind = kind_of(file);
    std::error_code ignored;
    if (kind == FileKind::unknown && needed == FileKind::job && fs::is_regular_file(file, ignored) && !is_zip(file))
        return input_error("{}: is not a zip archive, so it is no job; pliant slice makes one", file);
    if (kind == FileKind::unknown || kind == needed) return {};
    return input_error("{}", text_of(kind, file, needed));
}

Result<PrinterText> read_printer_file(const std::string& name) {
    if (!machine::is_printer_name(name)) {
        if (Status status = expect(FileKind::printer, name); !status) return tl::unexpected(status.error());
    }
    Result<std::string> text = machine::read_printer_text(name);
    if (!text) return tl::unexpected(text.error());
    Result<machine::Printer> printer = machine::parse_printer(*text, name);
    if (!printer) return tl::unexpected(printer.error());
    return PrinterText{std::move(*printer), std::move(*text)};
}

Result<machine::Printer> read_printer(const std::string& name) {
    Result<PrinterText> read = read_printer_file(name);
    if (!read) return tl::unexpected(read.error());
    return std::move(read->printer);
}

Result<robot::Robot> read_robot(const std::string& file, const std::vector<std::string>& assignments) {
    if (Status status = expect(FileKind::robot, file); !status) return tl::unexpected(status.error());
    return robot::load_robot(file, assignments);
}

Status check_results_place(const std::string& folder, const FolderMark& mark, const std::string& robot,
                           const std::vector<std::string>& assignments, const std::string& measured) {
    if (folder.empty()) return {};
    std::vector<fs::path> inputs = robot::files_of(robot, assignments);
    inputs.emplace_back(measured);
    for (const fs::path& input : inputs)
        if (Status outside = check_outside(input, folder); !outside) return outside;
    return check_folder_place(folder, mark);
}

tl::unexpected<Error> no_assignments(const std::string& file) {
    return input_error("{}: is no robot file; --set changes the keys of one", file);
}

Result<operate::OpenJob> read_job(const std::string& file) {
    Result<operate::OpenJob> job = operate::open_job(file);
    if (job) return job;
    if (Status status = expect(FileKind::job, file); !status) return tl::unexpected(status.error());
    return job;
}

Result<operate::ProvedJob> prove_job(const std::string& file, operate::Pixels pixels, const machine::Printer* other) {
    Result<operate::ProvedJob> job = operate::prove_job(file, pixels, other);
    if (job) return job;
    if (Status status = expect(FileKind::job, file); !status) return tl::unexpected(status.error());
    return job;
}

Result<job::Archive> read_archive(const std::string& file) {
    Result<job::Archive> archive = job::Archive::open(file);
    if (archive) return archive;
    if (Status status = expect(FileKind::job, file); !status) return tl::unexpected(status.error());
    return archive;
}

Status check_ending(std::string_view option, const std::string& file, std::string_view what, std::string_view ending) {
    const fs::path path(file);
    if (file.empty() || lower_extension(path) == ending) return {};
    return input_error("{} {}: {} ends in {}, as in {}", option, file, what, ending,
                       fs::path(path).replace_extension(ending).string());
}

}  // namespace pliant::app
