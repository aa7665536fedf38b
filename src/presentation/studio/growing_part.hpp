// How the part of a print under way is followed: of the virtual printer what has cured, of a machine at a port what has
// been exposed. Images are decoded and cells counted by whoever calls look_at() and news(), never by the print.
#pragma once

#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "presentation/print_report/cured_block.hpp"
#include "presentation/studio/paced_twin.hpp"
#include "printing/host/control_types.hpp"
#include "printing/operate/print_job.hpp"
#include "printing/twin/coarse_part.hpp"

namespace pliant::studio {

class GrowingPart {
public:
    /// Of the job in that file.
    GrowingPart(std::filesystem::path file, const operate::ReadyJob& job);

    /// A new print begins.
    void clear();
    /// A light has ended, at a port. From the thread that prints; remembers it and returns.
    void exposed(const host::Given& given);
    /// What an interrupted print has already exposed, by its journal. One that cannot be read recalls nothing.
    void recall(const std::filesystem::path& journal);
    /// What has cured since; `is_over`: no more light comes, the last layer is complete.
    void look_at(PacedTwin& twin, bool is_over);
    /// One image of the job, PNG. Errors: there is none.
    [[nodiscard]] Result<std::string> image(int layer, int material);
    /// {"type": "part", ...} if it has grown since the last call, else "".
    [[nodiscard]] std::string news();
    /// The slabs from `from` on, the last of which may still change; all of them if `revision` is not the present one.
    /// {"revision", "from", "closed", "cell_px", "height_mm", "kind": "cured" or "exposed"} and `slabs` (bottom and top
    /// of each, mm), `runs` (three numbers a run: slab | material << 24, row, begin | end << 16; in cells, slabs
    /// counted from the platform).
    [[nodiscard]] std::string packet(int revision, std::size_t from) const;

private:
    void take_exposed();
    [[nodiscard]] Result<job::Archive*> archive();
    [[nodiscard]] int revision() const { return revisions_before_ + part_.revision(); }

    std::filesystem::path file_;
    std::mutex archive_mutex_;
    std::unique_ptr<job::Archive> archive_;  ///< of its own, opened when it is needed: the print reads the other
    std::mutex waiting_mutex_;               ///< of what the print leaves here: it must not wait for anything else
    std::deque<host::Given> waiting_;
    std::vector<std::pair<int, int>> heights_;  ///< bottom and top of the job's layers, um
    std::vector<int> material_of_vat_;

    mutable std::mutex mutex_;
    const twin::CoarsePart empty_;
    twin::CoarsePart part_;
    bool cured_ = false;        ///< else exposed
    std::size_t seen_ = 0;      ///< layers of the twin's block
    int revisions_before_ = 0;  ///< of parts that are gone: a number never comes again
    bool grown_ = false;
};

/// The slabs of a part from `from` on, as GrowingPart::packet() tells them.
[[nodiscard]] std::string part_packet(const twin::CoarsePart& part, std::string_view kind, int revision,
                                      std::size_t from);

/// The block against the drawing, for the report. The print must be over. Null if an image of the job cannot be read.
[[nodiscard]] std::shared_ptr<const report::CuredBlock> block_of(PacedTwin& twin, const std::filesystem::path& file);

}  // namespace pliant::studio
