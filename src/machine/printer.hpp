// The printer file: everything that Pliant knows about a machine, as one plain value. docs/reference/printer.md
// describes the file; examples/printers/tower.toml is the prototype of the thesis (chapter 4, appendix B).
//
// The machine has three axes. The carriage carries the cleaning vat and drags the resin vat that is hooked to it: at
// `print_um` that vat lies under the platform, at `tower_um` it is inside the tower and the cleaning vat under the
// platform. The platform goes up and down over the vat. The tower lifts and lowers all its slots; slot n is level with
// the carriage at `level_um(n)`. Positions are integer micrometres, times seconds.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.hpp"

namespace pliant::machine {

enum class Axis { carriage, platform, tower };
inline constexpr std::size_t axis_count = 3;
inline constexpr std::array<Axis, axis_count> all_axes = {Axis::carriage, Axis::platform, Axis::tower};

/// "carriage", "platform", "tower": the table names of the printer file.
[[nodiscard]] std::string_view axis_name(Axis axis);

/// Where every axis is, in micrometres.
struct Position {
    std::array<int, axis_count> um{};

    int& operator[](Axis axis) { return um[static_cast<std::size_t>(axis)]; }
    int operator[](Axis axis) const { return um[static_cast<std::size_t>(axis)]; }
    bool operator==(const Position&) const = default;
};

struct AxisSpec {
    char letter = '?';  ///< in G-code
    int min_um = 0, max_um = 0;
    double speed_mm_s = 0, acceleration_mm_s2 = 0;
    bool homes_to_max = false;  ///< where its limit switch is
    double homing_speed_mm_s = 0;

    [[nodiscard]] int home_um() const { return homes_to_max ? max_um : min_um; }
};

struct Controller {
    std::string dialect = "marlin";
    int baud_rate = 115200;
    int window_lines = 4;    ///< lines that may wait for their `ok`: at most the firmware's BUFSIZE
    int window_bytes = 120;  ///< and their bytes: less than its receive buffer
};

struct Carriage {
    int print_um = 0;     ///< the hooked vat lies under the platform
    int tower_um = 0;     ///< the hooked vat is inside the tower
    int back_off_um = 0;  ///< how far the empty carriage must stand back before the tower may travel
    int shear_um = 0;     ///< sideways stroke from `print_um` that loosens a layer
    double shear_speed_mm_s = 0;
};

struct Platform {
    int width_um = 0, depth_um = 0;
    int build_height_um = 0;  ///< tallest part
    int clearance_um = 0;     ///< between the part's lowest point and the vat's rim while the carriage moves
    int lift_um = 0;          ///< lift that peels a layer and lets resin flow back
    double lift_speed_mm_s = 0;
    int approach_um = 0;  ///< the last stretch down into the resin
    double approach_speed_mm_s = 0;
    double settle_s = 0;  ///< rest before the exposure
};

struct Tower {
    int slots = 0;
    int first_slot_um = 0;  ///< tower position at which slot 1 is level with the carriage
    int pitch_um = 0;       ///< from slot to slot
    int clearance_um = 0;   ///< free height between two vats
};

struct Hooks {
    int travel_um = 0;  ///< how far the tower lowers until a vat is off its hooks
    double speed_mm_s = 0;
};

struct VatShape {
    int wall_um = 0;            ///< height of the walls above the floor
    double volume_ml = 0;       ///< inside
    double free_volume_ml = 0;  ///< what the vat takes with the platform in it
};

struct Vat {
    int slot = 0;       ///< where it lives, from 1
    std::string resin;  ///< "" if empty
    double fill_ml = 0;
};

struct Resin {
    std::string name;
    double exposure_s = 0;
    double bottom_exposure_s = 0;  ///< of the first `bottom_layers` layers
    int bottom_layers = 0;
    int cure_depth_um = 0;      ///< thickest layer that still holds on to the one before
    double critical_share = 0;  ///< share of `exposure_s` below which a pixel stays liquid
};

struct Projector {
    int width_px = 0, height_px = 0;
    double pixel_um = 0;
    bool mirror_x = false, mirror_y = false;  ///< how the panel is seen from the platform
    double rotation_deg = 0;                  ///< of the part in the image, counter-clockwise
    double offset_x_um = 0, offset_y_um = 0;  ///< of the platform's centre from the image's
    std::vector<double> grey;  ///< light of pixels covered 0, 1/n, ... 1: shares of full light; none: the coverage
    std::string mask;          ///< image file beside the printer file: share of light that each pixel may get
    double irradiance_W_m2 = 0;
    double delay_s = 0;  ///< from the command to the changed image
};

struct Cleaning {
    double spray_s = 0;
    int stroke_x_um = 0, stroke_z_um = 0;  ///< oscillation of the carriage and of the platform
    double speed_mm_s = 0;                 ///< of the carriage while it oscillates
    double dry_s = 0;                      ///< fans after the new vat is in; 0: only while it is pulled in
    bool brush = false;                    ///< wipes the part while the vat is pushed away
};

/// The commands of something that hangs on an auxiliary pin; "" if the machine has none.
struct Switch {
    std::string on, off;
};

/// A validated machine. Indices into `vats` are what the planner calls a vat.
struct Printer {
    std::string name;
    int layer_um = 50;
    Controller controller;
    std::array<AxisSpec, axis_count> axes;
    Carriage carriage;
    Platform platform;
    Tower tower;
    Hooks hooks;
    VatShape vat_shape;
    std::vector<Vat> vats;
    std::vector<Resin> resins;
    Projector projector;
    Cleaning cleaning;
    Switch pump, fans;

    [[nodiscard]] const AxisSpec& axis(Axis a) const { return axes[static_cast<std::size_t>(a)]; }
    /// Tower position at which `slot` (from 1) is level with the carriage.
    [[nodiscard]] int level_um(int slot) const { return tower.first_slot_um + (slot - 1) * tower.pitch_um; }
    /// Lowest platform position at which a part of `part_height_um` hangs free of the vat.
    [[nodiscard]] int clear_um(int part_height_um) const {
        return part_height_um + vat_shape.wall_um + platform.clearance_um;
    }
    [[nodiscard]] const Resin* find_resin(std::string_view resin) const;  ///< nullptr if unknown
    [[nodiscard]] const Vat* vat_of_slot(int slot) const;                 ///< nullptr if none is fitted
};

/// Reads and validates a printer file: units, ranges, and that every station lies within the travel of its axis.
/// Errors name file, line and key.
[[nodiscard]] Result<Printer> load_printer(const std::filesystem::path& path);
[[nodiscard]] Result<Printer> parse_printer(std::string_view text, const std::filesystem::path& file);

}  // namespace pliant::machine
