/// @file
/// Multi-resin printing: from bodies to a job file, its plan, its verification, and a print on the virtual printer.
///
/// Names end in their unit: mm, ml, s. A job is a file (.zip) that holds layer images, the printer, the plan and the
/// G-code; nothing else is kept between calls.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pliant/base.hpp"

namespace pliant {

/// What to slice, and how. Lengths are texts with a unit, as in "50 um"; empty: the printer's default.
struct SliceOptions {
    /// One robot file; or any number of FILE.3mf, FILE.vtk (one material per region) and MATERIAL=FILE (a surface or
    /// solid).
    std::vector<std::string> inputs;
    std::filesystem::path printer;     ///< printer file (TOML), or the name of a built-in printer: "tower"
    std::vector<std::string> changes;  ///< overrides of the robot file, KEY=VALUE
    std::vector<std::string> resins;   ///< MATERIAL=RESIN: the resin each material is printed in
    std::string layer;                 ///< layer height
    int copies = 1;                    ///< placed side by side; at least 1
    bool any_vat = false;              ///< fill a resin that no vat holds into a free vat
    std::string support;               ///< material of the supports; empty: no supports
};

/// What a job needs on its printer.
struct PrintPlan {
    /// A vat used by the job.
    struct Vat {
        int slot = 0;         ///< its place in the tower, from 1
        std::string resin;    ///< the resin it must hold
        double resin_ml = 0;  ///< used by the job
        bool refill = false;  ///< to be filled in before the print: the printer file has another resin there, or none
        std::vector<int> refills;  ///< layers, from 0, before which it must be refilled during the print
    };
    int layers = 0;                     ///< number of layers of the part
    int swaps = 0;                      ///< number of vat swaps
    double seconds = 0;                 ///< total printing time, s
    double swap_s = 0;                  ///< of this: swaps
    double clean_s = 0;                 ///< of this: cleaning
    double expose_s = 0;                ///< of this: exposure
    double move_s = 0;                  ///< of this: all other motion
    double solution_ml = 0;             ///< cleaning solution used
    std::vector<Vat> vats;              ///< in the order of the printer file
    std::vector<std::string> warnings;  ///< one sentence each
};

/// Slices and plans, and writes the job file, whole or not at all.
/// @throws Failure if the options or the geometry are invalid, slicing or planning fails, or the file cannot be
/// written; or when cancelled.
PLIANT_API PrintPlan slice_job(const SliceOptions& options, const std::filesystem::path& job, const Watch& watch = {});

/// Recomputes the plan of a job for the printer stored in it.
/// @throws Failure if the file cannot be read or is invalid.
[[nodiscard]] PLIANT_API PrintPlan plan_job(const std::filesystem::path& job);

/// Verifies a job as is done before every print: each image against its checksum, the G-code against the machine.
/// Returns warnings about what could not be verified, one sentence each.
/// @throws Failure if the file cannot be read or the job does not pass; the message names the file and, where it
/// applies, the entry or line and the layer; or when cancelled.
PLIANT_API std::vector<std::string> check_job(const std::filesystem::path& job, const Watch& watch = {});

/// The cured part as voxels: one projector pixel wide, one cured layer high; just large enough to hold everything.
struct CuredBlock {
    std::array<std::size_t, 3> size{};  ///< voxels along x, y and z
    Point corner_mm{};                  ///< minimum x, y and z, in the coordinates of the platform
    double pixel_mm = 0;                ///< length of a voxel along x and y
    std::vector<double> bottoms_mm;     ///< (z) lower side of each layer
    std::vector<double> tops_mm;        ///< (z) upper side of each layer
    std::vector<std::string> resins;    ///< resins that have cured
    std::vector<std::uint8_t> resin;    ///< (z, y, x) k: the k-th of `resins`, that with the largest share; 0: none
    std::vector<std::uint8_t> share;    ///< (z, y, x) solid fraction of the voxel, 255: all of it
};

/// Optional results of a virtual print.
struct VirtualPrintOptions {
    bool block = false;  ///< the cured block: one or two bytes per voxel
};

/// Result of a print on the virtual printer.
struct VirtualPrint {
    bool passed = false;               ///< the part matches the job, and no error occurred
    std::vector<std::string> reasons;  ///< why it did not pass, one sentence each
    double seconds = 0;                ///< on the machine's clock
    int layers = 0;                    ///< number of cured layers
    /// (material, volume cured in its own resin, mm^3)
    std::vector<std::pair<std::string, double>> cured_mm3;
    std::string journal;                      ///< of the print, as written by the host
    std::shared_ptr<const CuredBlock> block;  ///< if requested; otherwise null
};

/// Prints a job on the virtual printer, with the same code that drives real machines; takes seconds.
/// @throws Failure if the job is invalid, the print fails, or the block has more than 4 * 10^9 voxels; or when
/// cancelled.
[[nodiscard]] PLIANT_API VirtualPrint print_virtually(const std::filesystem::path& job, const Watch& watch = {},
                                                      const VirtualPrintOptions& options = {});

}  // namespace pliant
