// What the readers of a robot file's tables share.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/core/config.hpp"
#include "geometry/shapes/solid.hpp"
#include "robot/description/robot.hpp"

namespace pliant::robot {

/// The robot so far, and what its tables are read with.
struct Context {
    Robot& robot;
    config::Problems& problems;
    mesh::NamedShapes shapes;  ///< [shape.NAME]: solids that others may use
    bool moves_in_time;        ///< program.time_step is given
    /// Names of cables and chambers whose target is none of the known ones: that is reported, and what their offset,
    /// range and keys mean cannot be told.
    std::set<std::string> unclear_targets = {};
};

/// A problem if `key`, which says something about a motion in time, acts (`is_used`) in a program that has none.
void check_needs_time(config::Reader& reader, std::string_view key, bool is_used, const Context& context);

/// Whether a name that was read is blank, with a problem where it is given so.
bool refuse_blank(config::Reader& reader, const std::string& name);

/// The key `name`; a problem if it is blank, or if it stands in `taken`, to which it is added. `kind` is the plural for
/// the message.
[[nodiscard]] std::string read_name(config::Reader& reader, std::set<std::string>& taken, std::string_view kind);

/// `file`, which the text of `key` names, as seen from the robot file's folder; a problem if there is no such file.
[[nodiscard]] std::filesystem::path need_file(config::Reader& reader, std::string_view key, const std::string& file,
                                              const Context& context);

/// `box`: two corners, the lower one first. Empty where it is missing or wrong.
[[nodiscard]] BoxSelector read_box(config::Reader& reader);

/// Of length 1, however large or small its components are; zero for a zero vector.
[[nodiscard]] Vec3 direction_along(const Vec3& vector);

/// `plane`: a point and a normal that is not zero, nor of components whose squares are no numbers.
[[nodiscard]] PlaneSelector read_plane(config::Reader& reader);

/// The table `key`: where a mesh from a file is put. The file as it is, where the key is missing.
[[nodiscard]] mesh::Placement read_placement(config::Reader& reader, std::string_view key);

/// `geometry`, written as a shape. Precondition: the key is there.
[[nodiscard]] mesh::Solid read_shape(config::Reader& reader, Context& context);

/// Marks every key as read, where none can be judged.
void skip_keys(config::Reader& reader);

/// Reads every [[key]] of `root` into `list`: its line, its name, which is unique among its kind, and by
/// `read(reader, context, spec)` what else it says.
template <typename Spec, typename Read>
void read_each(config::Reader& root, Context& context, std::string_view key, std::string_view kind,
               std::vector<Spec>& list, const Read& read) {
    std::set<std::string> taken;
    for (config::Reader& reader : root.tables(key)) {
        Spec spec;
        spec.line = reader.line();
        spec.name = read_name(reader, taken, kind);
        read(reader, context, spec);
        reader.finish();
        list.push_back(std::move(spec));
    }
}

}  // namespace pliant::robot
