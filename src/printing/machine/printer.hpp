// The printer file: everything that Pliant knows about a machine, as one plain value. docs/reference/printer.md
// describes the file; examples/printers has the machines of the thesis (chapter 4, appendix B) and related ones.
//
// A platform moves up and down over a vat. The other vats are in the store, which is one of four kinds:
//   tower  A carriage carries the cleaning vat and drags the resin vat that is hooked to it: at `print_um` that vat
//          is under the platform, at `tower_um` it is inside the tower and the cleaning vat under the platform. The
//          tower lifts and lowers all its slots; slot n is level with the carriage at `level_um(n)`. Several towers
//          stand on a table that brings one of them before the carriage, linearly or (a carousel) in a circle.
//   wall   The same carriage, but what it meets at `tower_um` is the tray of a retriever: a lift on a rail along a wall
//          of vats in rows and columns, whose fork takes a vat from its place or puts it there.
//   table  The vats and a cleaning station are on a table, one of them under the platform: a turntable or a conveyor.
//   none   One vat, fixed under the platform.
// Positions are integer micrometres, those of a rotary axis thousandths of a degree; times are in seconds.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.hpp"
#include "printing/machine/marlin_release.hpp"

namespace pliant::machine {

enum class Store { none, table, tower, wall };

/// With a wall, `tower` is the lift of the retriever and `table` its rail.
enum class Axis { carriage, platform, tower, table };
inline constexpr std::size_t axis_count = 4;
inline constexpr std::array<Axis, axis_count> all_axes = {Axis::carriage, Axis::platform, Axis::tower, Axis::table};

/// "carriage", "platform", "tower", "table", with a wall "lift" and "rail": the names of the tables in the printer
/// file.
[[nodiscard]] std::string_view axis_name(Axis axis, Store store = Store::tower);

/// Position of every axis, in micrometres (rotary: 1/1000 degree).
struct Position {
    std::array<int, axis_count> um{};

    int& operator[](Axis axis) { return um[static_cast<std::size_t>(axis)]; }
    int operator[](Axis axis) const { return um[static_cast<std::size_t>(axis)]; }
    bool operator==(const Position&) const = default;
};

/// The drive train of an axis. Not needed to plan or print: for building and checking the firmware.
struct Drive {
    int motors = 1;          ///< each on an output of its own, stepping together
    int motor_steps = 200;   ///< full steps per turn of the motor
    int microsteps = 16;     ///< per full step
    double gear = 1;         ///< motor turns per turn of the output
    double per_turn_mm = 0;  ///< travel per turn of the output (degrees if rotary); 0: unknown

    [[nodiscard]] bool known() const { return per_turn_mm > 0; }
    [[nodiscard]] double steps_per_mm() const { return motor_steps * microsteps * gear / per_turn_mm; }
};

struct AxisSpec {
    char letter = '?';  ///< in G-code; '?': the machine has no such axis
    int min_um = 0, max_um = 0;
    double speed_mm_s = 0, acceleration_mm_s2 = 0;
    bool homes_to_max = false;  ///< position of its limit switch
    double homing_speed_mm_s = 0;
    double jerk_mm_s = 0;        ///< speed from which it may stop instantly, and to which it may start
    bool rotary = false;         ///< degrees instead of mm everywhere; positions repeat every full turn
    bool homes_by_hand = false;  ///< no limit switch (E of a classic build): placed by a person, set with G92
    Drive drive{};               ///< between motor and axis

    [[nodiscard]] bool present() const { return letter != '?'; }
    [[nodiscard]] int home_um() const { return homes_to_max ? max_um : min_um; }
};

enum class Dialect {
    marlin,   ///< 2.1 and later: extra axes A B C U V W
    classic,  ///< 1.x on RAMPS: four axes, so the tower is Y or E
};

struct Controller {
    Dialect dialect = Dialect::marlin;
    MarlinRelease firmware = MarlinRelease::v2_1_2;  ///< release that the board runs
    int baud_rate = 115200;
    int window_lines = 4;    ///< lines sent before their `ok`: at most the firmware's BUFSIZE
    int window_bytes = 120;  ///< bytes of these lines: less than its receive buffer
};

struct Carriage {
    int print_um = 0;     ///< the hooked vat is under the platform
    int tower_um = 0;     ///< the hooked vat is inside the tower
    int back_off_um = 0;  ///< how far the empty carriage must stand back before the tower may move
    int shear_um = 0;     ///< sideways stroke from `print_um` that loosens a layer
    double shear_speed_mm_s = 0;
    bool along_y = false;  ///< the carriage moves along the depth of the platform (y of the part), not along its width
};

struct Platform {
    int width_um = 0, depth_um = 0;
    int build_height_um = 0;  ///< tallest part
    int clearance_um = 0;     ///< between the part's lowest point and the vat's rim while vats move
    int lift_um = 0;          ///< lift that peels a layer and lets resin flow back
    double lift_speed_mm_s = 0;
    int approach_um = 0;  ///< the last part of the way down into the resin
    double approach_speed_mm_s = 0;
    double settle_s = 0;  ///< wait before the exposure
};

struct Tower {
    int slots = 0;          ///< per tower; 0: the machine has none
    int first_slot_um = 0;  ///< tower position at which slot 1 is level with the carriage
    int pitch_um = 0;       ///< from slot to slot
    int clearance_um = 0;   ///< free height between two vats
};

struct Table {
    std::vector<int> stations_um;  ///< position of each vat, or of each tower; empty: no table
    int cleaning_um = 0;           ///< of the cleaning station; tables without towers only
    int bath_gap_um = 0;           ///< between the part and the floor of the cleaning station
};

/// The commands that switch a device on an auxiliary pin; "" if the machine has none.
struct Switch {
    std::string on, off;
};

/// An electromagnet that holds the vat instead of hooks, which saves their stroke (thesis, chapter 5).
struct Magnet {
    Switch coil;            ///< on: it holds
    double engage_s = 0;    ///< time until it holds
    double release_s = 0;   ///< time until it releases
    double force_N = 0;     ///< holding force; 0: unknown and not checked
    double vat_kg = 0;      ///< of an empty vat
    double friction = 0.3;  ///< of a vat on its rails
    double resin_kg_m3 = 1100;

    [[nodiscard]] bool present() const { return !coil.on.empty(); }
};

struct Hooks {
    int travel_um = 0;  ///< how far the tower lowers to free a vat from its hooks; 0 with a magnet
    double speed_mm_s = 0;
    Magnet magnet{};
};

/// Vats in rows and columns, and the retriever in front of them. Slots count along the rows, starting with the lowest.
struct Wall {
    int rows = 0, columns = 0;                     ///< 0: the machine has none
    int first_row_um = 0, row_pitch_um = 0;        ///< of the lift, level with the places of a row
    int first_column_um = 0, column_pitch_um = 0;  ///< of the rail
    int bay_lift_um = 0, bay_rail_um = 0;          ///< the tray is level with the carriage, and in front of it
    int lift_off_um = 0;                           ///< stroke of the lift between a vat resting on its place and on the
                                                   ///< fork
    double lift_off_mm_s = 0;
    int clearance_um = 0;  ///< free height between two vats of a column
    Switch fork;           ///< on: extended into the wall
    double fork_s = 0;     ///< duration of extending or retracting
};

struct VatShape {
    int wall_um = 0;            ///< height of the walls above the floor
    double volume_ml = 0;       ///< inside
    double free_volume_ml = 0;  ///< capacity with the platform in it
    double least_ml = 0;        ///< minimum that covers the floor
};

struct Vat {
    int slot = 0;       ///< its place, from 1
    std::string resin;  ///< "" if empty
    double fill_ml = 0;
};

struct Resin {
    std::string name;
    double exposure_s = 0;
    double bottom_exposure_s = 0;  ///< of the first `bottom_layers` layers
    int bottom_layers = 0;
    int cure_depth_um = 0;       ///< thickest layer that still bonds to the one before
    double critical_share = 0;   ///< fraction of `exposure_s` below which a pixel stays liquid
    double penetration_um = 0;   ///< Dp of the working curve (Jacobs); 0: from cure_depth and critical_share
    double critical_J_m2 = 0;    ///< Ec of the working curve
    int xy_compensation_um = 0;  ///< moves the outer borders of prints in it outwards; negative: inwards
    int elephant_foot_um = 0;    ///< and inwards in the first layer, decreasing linearly up to `elephant_foot_layers`
    int elephant_foot_layers = 0;
    int transition_layers = 0;      ///< above the bottom ones, with linearly decreasing exposure
    int bleed_compensation_um = 0;  ///< depth to which light cures below its layer where nothing should be
};

struct Projector {
    int width_px = 0, height_px = 0;
    double pixel_um = 0;
    bool mirror_x = false, mirror_y = false;  ///< orientation of the panel seen from the platform
    double rotation_deg = 0;                  ///< rotation of the part in the image, counter-clockwise
    double offset_x_um = 0, offset_y_um = 0;  ///< platform's centre from the image's centre
    std::vector<double> grey;  ///< light of pixels with coverage 0, 1/n, ... 1, as fractions of full light; empty:
                               ///< equal to the coverage
    std::string mask;          ///< image file beside the printer file: fraction of light that each pixel may get
    double irradiance_W_m2 = 0;
    double delay_s = 0;  ///< from the command to the change of the image
};

enum class CleaningMethod { spray, ultrasound, bath };

/// "spray", "ultrasound", "bath".
[[nodiscard]] std::string_view method_name(CleaningMethod method);

/// Settings for the change from a vat of resin `from` to one of resin `to`.
struct CleaningPair {
    std::string from, to;
    double spray_s = 0;    ///< replaces Cleaning::spray_s
    double penalty_s = 0;  ///< cost of this pair to the planner
};

struct Cleaning {
    CleaningMethod method = CleaningMethod::spray;
    double spray_s = 0;                    ///< duration of cleaning, whatever the method
    int stroke_x_um = 0, stroke_z_um = 0;  ///< oscillation of the carriage and of the platform
    double speed_mm_s = 0;                 ///< of the carriage (with a table: of the platform) while it oscillates
    double dry_s = 0;                      ///< all fans after the new vat is in; 0: only while it is pulled in
    bool brush = false;                    ///< in every vat: wipes the part while its vat is pushed into the tower
    int film_um = 0;                       ///< thickness of the resin film on the part's cross-section
    double solvent_ml_s = 0;               ///< solution used per second of cleaning
    double most_contamination = 0;         ///< fraction of foreign resin in a vat above which a print fails
    std::vector<CleaningPair> pairs;
    int brush_um = 0;        ///< height of the part's lowest point above the vat's rim while the brush wipes it
    double brush_share = 0;  ///< fraction of the film on the part that the brush returns to its vat
};

/// The reservoir of the cleaning solution, its drain and its filter.
struct Solution {
    double volume_ml = 0;         ///< capacity; 0: the machine has no reservoir, every cleaning takes fresh solution
    double fill_ml = 0;           ///< content at the start
    double resin_share = 0;       ///< fraction of resin in that
    double least_ml = 0;          ///< level below which the pump draws air
    double spray_loss = 0;        ///< fraction of the pumped solution that evaporates and does not return through the
                                  ///< drain
    double evaporation_ml_h = 0;  ///< from the reservoir, per hour
    double spent_share = 0;       ///< fraction of resin at which the solution must be changed
    double filter_share = 0;      ///< fraction of the washed-off resin that the filter retains
    double filter_ml = 0;         ///< amount of resin that fills the filter

    [[nodiscard]] bool present() const { return volume_ml > 0; }
};

/// A spray nozzle in the cleaning vat (thesis, figure 4.3): a cone of drops, uniform over all its directions.
struct Sprinkler {
    /// x and y in the part's frame, from the middle of the platform, with the carriage at the tower (with a table: with
    /// the cleaning station under the platform); z above the floor of the cleaning vat.
    std::array<double, 3> place_mm{};
    std::array<double, 3> aim{0, 0, 1};  ///< unit vector
    double cone_rad = 0;                 ///< full angle
    double flow = 1;                     ///< its share of the pumped solution, relative to the other nozzles
};

/// A switch at the end of an axis' travel. The controller reads it; M119 reports TRIGGERED while it is pressed.
struct LimitSwitch {
    Axis axis = Axis::platform;
    bool at_max = false;    ///< at the upper end of the travel
    bool inverted = false;  ///< normally open: the firmware must invert its reading
};

/// A switch that is pressed while the door (lid, hood) is open, on a spare switch input of the controller.
struct DoorSwitch {
    std::string input;  ///< as in M119: "y_max"; "": the machine has none
    bool inverted = false;

    [[nodiscard]] bool present() const { return !input.empty(); }
};

/// How the host stops the machine without the controller's help.
struct EmergencyLine {
    enum class Signal {
        none,
        controller,  ///< a relay on a pin of the board, which the firmware releases when it is killed (M112)
        dtr,         ///< a control line of a separate serial port: high in normal operation, dropped to stop
        rts,
        file,  ///< a file that switches a pin of the computer, such as a GPIO
    };
    Signal signal = Signal::none;
    std::string device;     ///< port or file
    int pin = 0;            ///< of the board
    bool stop_high = true;  ///< of the file: "1" stops, "0" lets run; false: the other way round
};

/// "none", "controller", "dtr", "rts", "file".
[[nodiscard]] std::string_view signal_name(EmergencyLine::Signal signal);

/// Limits that no program may exceed, whatever the job says.
struct Limits {
    double exposure_s = 3600;  ///< longest exposure
    double cleaning_s = 3600;  ///< longest continuous run of the pump
};

/// A validated machine. The planner refers to vats by their index in `vats`.
struct Printer {
    std::string name;
    int layer_um = 50;
    Controller controller;
    std::array<AxisSpec, axis_count> axes;
    Carriage carriage;
    Platform platform;
    Tower tower;
    Hooks hooks;
    Table table;
    VatShape vat_shape;
    std::vector<Vat> vats;
    std::vector<Resin> resins;
    Projector projector;
    Cleaning cleaning;
    Switch pump;
    std::vector<Switch> fans;
    std::vector<LimitSwitch> limit_switches;  ///< empty: not listed; each axis then has one where it homes
    DoorSwitch door;
    EmergencyLine emergency_line;
    Limits limits;
    Solution solution{};
    std::vector<Sprinkler> sprinklers{};  ///< empty: positions unknown
    Wall wall{};

    [[nodiscard]] const AxisSpec& axis(Axis a) const { return axes[static_cast<std::size_t>(a)]; }
    [[nodiscard]] Store store() const {
        if (tower.slots > 0) return Store::tower;
        if (wall.rows > 0) return Store::wall;
        return table.stations_um.empty() ? Store::none : Store::table;
    }
    /// Whether vats are dragged by a carriage, from a tower or from the retriever of a wall.
    [[nodiscard]] bool has_carriage() const { return store() == Store::tower || store() == Store::wall; }
    /// Whether the table has a position for each slot or tower or, as the rail, for the retriever's bay.
    [[nodiscard]] bool has_table() const { return axis(Axis::table).present(); }
    /// Number of places for vats: slots of all towers, places of the wall, stations, or one.
    [[nodiscard]] int slot_count() const;
    /// Tower position at which `slot` (from 1) is level with the carriage; with a wall, the lift's at the bay.
    [[nodiscard]] int level_um(int slot) const {
        if (store() == Store::wall) return wall.bay_lift_um;
        return tower.first_slot_um + (slot - 1) % tower.slots * tower.pitch_um;
    }
    /// Table position at which `slot` (its vat, or its tower) is in place; for a rotary table within one turn; with a
    /// wall, the rail's at the bay.
    [[nodiscard]] int station_um(int slot) const;
    /// Lift and rail positions of a wall's retriever with the tray level with the place of `slot`.
    [[nodiscard]] int row_um(int slot) const {
        return wall.first_row_um + (slot - 1) / wall.columns * wall.row_pitch_um;
    }
    [[nodiscard]] int column_um(int slot) const {
        return wall.first_column_um + (slot - 1) % wall.columns * wall.column_pitch_um;
    }
    /// The table position equivalent to `target_um` (modulo full turns on a rotary table) that is nearest to `from_um`,
    /// within the axis' travel.
    [[nodiscard]] int nearest_um(int target_um, int from_um) const;
    /// Whether the table is at `target_um`, modulo full turns.
    [[nodiscard]] bool table_at(int table_um, int target_um) const;
    /// Lowest platform position at which a part of `part_height_um` is clear of the vat.
    [[nodiscard]] int clear_um(int part_height_um) const {
        return part_height_um + vat_shape.wall_um + platform.clearance_um;
    }
    [[nodiscard]] bool has_brush() const { return cleaning.brush && has_carriage(); }
    /// Platform position at which a vat is put away: the brush reaches the part; without a brush, clear_um().
    [[nodiscard]] int push_um(int part_height_um) const {
        return has_brush() ? part_height_um + vat_shape.wall_um + cleaning.brush_um : clear_um(part_height_um);
    }
    /// Fraction of the film on the part that the brush returns to a vat that is put away.
    [[nodiscard]] double brushed_share() const { return has_brush() ? cleaning.brush_share : 0; }
    /// Carriage positions at which the part is over the cleaning vat's drain: from `drain_begin_um` to `tower_um`.
    [[nodiscard]] int drain_begin_um() const { return carriage.tower_um - carriage.back_off_um - cleaning.stroke_x_um; }
    [[nodiscard]] const Resin* find_resin(std::string_view resin) const;  ///< nullptr if not in the file
    /// Precondition: there is such a vat.
    [[nodiscard]] int slot_of(int vat) const { return vats[static_cast<std::size_t>(vat)].slot; }
    [[nodiscard]] const Vat* vat_of_slot(int slot) const;  ///< nullptr if the slot has none
    /// What is in a vat once it is filled: its fill, or, of an empty one that has none, all that it can hold.
    [[nodiscard]] double filled_ml(const Vat& vat) const;
    /// Cleaning time between two vats (indices), and the planner's penalty for the pair.
    [[nodiscard]] double cleaning_s(int from_vat, int to_vat) const;
    [[nodiscard]] double penalty_s(int from_vat, int to_vat) const;
};

/// Reads and validates a printer file: units, ranges, and that every station is within the travel of its axis.
/// Errors name file, line and key.
[[nodiscard]] Result<Printer> load_printer(const std::filesystem::path& path);
[[nodiscard]] Result<Printer> parse_printer(std::string_view text, const std::filesystem::path& file);

}  // namespace pliant::machine
