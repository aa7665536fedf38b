/// @file
/// Printing in several resins: from bodies to a job file, its plan, its proof, and a print on the virtual printer.
///
/// Micrometres inside, millimetres and seconds where a name says so. A job is a file (.zip) that holds layer images,
/// the printer, the plan and the G-code; nothing else is kept between the calls.
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

/// What is to be sliced, and how. Lengths are texts with a unit, as in "50 um"; an empty one is the printer's default.
struct SliceOptions {
    /// One robot file; or any of FILE.3mf, FILE.vtk (regions are materials) and MATERIAL=FILE of a surface or solid.
    std::vector<std::string> inputs;
    std::filesystem::path printer;     ///< printer file (TOML)
    std::vector<std::string> changes;  ///< KEY=VALUE of the robot file
    std::vector<std::string> resins;   ///< MATERIAL=RESIN: what a material is printed in
    std::string layer;                 ///< height of a layer
    int copies = 1;                    ///< side by side
    bool any_vat = false;              ///< a resin that no vat holds is filled into a free one
    std::string support;               ///< material of supports; empty: none
};

/// What a job takes on its printer.
struct PrintPlan {
    /// A vat that the job uses.
    struct Vat {
        int slot = 0;         ///< where it stands, from 1
        std::string resin;    ///< what it must hold
        double resin_ml = 0;  ///< that the job uses
        bool refill = false;  ///< the printer file names another resin for it, or none
    };
    int layers = 0;                     ///< of the part
    int swaps = 0;                      ///< changes of vat
    double seconds = 0;                 ///< in all
    double swap_s = 0;                  ///< of them, for changes of vat
    double clean_s = 0;                 ///< for cleaning
    double expose_s = 0;                ///< for light
    double move_s = 0;                  ///< for all other motion
    double solution_ml = 0;             ///< cleaning solution used up
    std::vector<Vat> vats;              ///< in the order of the printer file
    std::vector<std::string> warnings;  ///< a sentence each
};

/// Slices, plans and writes the job file, whole or not at all.
/// @throws Failure of the options, the geometry, the slicer, the planner or the disk; cancelled.
PLIANT_API PrintPlan slice_job(const SliceOptions& options, const std::filesystem::path& job, const Watch& watch = {});

/// Plans a job again, for its own printer.
/// @throws Failure of the file.
[[nodiscard]] PLIANT_API PrintPlan plan_job(const std::filesystem::path& job);

/// Proves a job as everything that prints does: every image against its fingerprint, the G-code against the machine.
/// Gives warnings, of what could not be proved.
/// @throws Failure that names file, entry or line, and layer.
PLIANT_API std::vector<std::string> check_job(const std::filesystem::path& job);

/// What has cured, voxel by voxel: pixels of the projector across, cured layers up; as large as it must be to hold all.
struct CuredBlock {
    std::array<std::size_t, 3> size{};  ///< voxels along x, y and z
    Point corner_mm{};                  ///< the lowest x, y and z of the block, on the printer's platform
    double pixel_mm = 0;                ///< length of a voxel along x and y
    std::vector<double> bottoms_mm;     ///< (z) where a layer begins
    std::vector<double> tops_mm;        ///< (z) where it ends
    std::vector<std::string> resins;    ///< that have cured
    std::vector<std::uint8_t> resin;    ///< (z, y, x) 0: none, k: the k-th of `resins`; of several the one with most
    std::vector<std::uint8_t> share;    ///< (z, y, x) of the voxel that is solid, 255: all of it
};

/// What is wanted of a virtual print beside its verdict.
struct VirtualPrintOptions {
    bool block = false;  ///< the cured block: a byte or two for each voxel
};

/// What a print on the virtual printer came to.
struct VirtualPrint {
    bool passed = false;               ///< the part is as the job asks, and nothing happened that must not
    std::vector<std::string> reasons;  ///< why it did not pass, a sentence each
    double seconds = 0;                ///< of the machine's clock
    int layers = 0;                    ///< that cured
    /// (material, volume that cured in its own resin, mm^3)
    std::vector<std::pair<std::string, double>> cured_mm3;
    std::string journal;                      ///< of the print, as the host writes it
    std::shared_ptr<const CuredBlock> block;  ///< where the options ask for it; else null
};

/// Prints a job on the virtual printer, by the engine that prints on machines; takes seconds.
/// @throws Failure of the job, of the print; cancelled; a block of more than 4 * 10^9 voxels.
[[nodiscard]] PLIANT_API VirtualPrint print_virtually(const std::filesystem::path& job, const Watch& watch = {},
                                                      const VirtualPrintOptions& options = {});

}  // namespace pliant
