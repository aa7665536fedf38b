// A robot file as a tree of values: what it stands on, and what changes it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/core/config.hpp"
#include "base/core/error.hpp"

namespace pliant::robot {

/// The value of a key of a table; null if there is none.
[[nodiscard]] const config::Value* entry_of(const config::Value& value, std::string_view key);

/// A robot with what the files say that stand on it.
struct BasedDocument {
    config::Document document;
    bool has_other_program = false;  ///< a file that stands on the robot has a [program] of its own
    bool has_other_course = false;   ///< and in it another duration, or keys
    bool sets_goal_times = false;    ///< such a file sets `times` of a goal
};

/// Of robot = "FILE.toml" that robot, changed by set = ["KEY=VALUE", ...], with what [program] says here in place of
/// what it says there; that file may stand on another one in turn, and so on. Without that key the document as it is.
/// Errors: of any of the files; any other key beside those; a file that stands on itself.
[[nodiscard]] Result<BasedDocument> on_base(config::Document document);

/// `text` is that of `file`. The texts of the robot that it names as robot = "FILE.toml" and of those that this stands
/// on; none without that key. Errors: of the texts; a named file cannot be read.
[[nodiscard]] Result<std::optional<std::string>> base_text(std::string_view text, const std::filesystem::path& file);

/// What a robot is read from, as far as it is there: the file, those that it stands on, and the files that these and
/// the assignments name. What cannot be read names none.
[[nodiscard]] std::vector<std::filesystem::path> files_of(const std::filesystem::path& file,
                                                          const std::vector<std::string>& assignments);

/// `text` is that of `file`. One digest of all meshes, surfaces and tables that it, what it stands on, and the
/// assignments name; "" if they name none. Errors: of the text and what it stands on, of an assignment; a file that
/// cannot be read.
[[nodiscard]] Result<std::string> digest_of_named_files(std::string_view text, const std::filesystem::path& file,
                                                        const std::vector<std::string>& assignments);

/// True if one of these "KEY=VALUE" is of the `times` of a goal.
[[nodiscard]] bool set_goal_times(const std::vector<std::string>& assignments);

/// Applies each "KEY=VALUE". Errors: those of config::set(); a material, parameter or shape that the document does not
/// have and nothing in it uses.
[[nodiscard]] Status set_all(config::Document& document, const std::vector<std::string>& assignments);

/// Why the value at `path` changes nothing: it is the target of a cable or chamber that keys of the program drive, and
/// only its kind counts. Says which key to set instead; empty: nothing of that kind.
[[nodiscard]] std::string why_idle(const config::Document& document, std::string_view path);

/// The numbers of [parameters] that are written as numbers, not as formulas of others, in the order of the file.
/// Errors: of the text and what it stands on, of an assignment.
[[nodiscard]] Result<std::vector<std::pair<std::string, double>>> free_parameters(
    std::string_view text, const std::filesystem::path& file, const std::vector<std::string>& assignments);

/// `text` is that of `file`. Text of a robot file in `folder` that says the same with these assignments, without
/// comments; files that are there are named from `folder`. Errors: of the text and what it stands on, of an assignment.
[[nodiscard]] Result<std::string> robot_text(std::string_view text, const std::filesystem::path& file,
                                             const std::vector<std::string>& assignments,
                                             const std::filesystem::path& folder);

}  // namespace pliant::robot
