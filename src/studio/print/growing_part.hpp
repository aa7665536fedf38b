// Tracks the growing part of a running print: what has cured in the virtual printer, or what has been exposed on a real
// machine. Images are decoded and cells counted by the caller of look_at() and news(), never by the print's thread.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "presentation/print_report/cured_block.hpp"
#include "printing/host/control_types.hpp"
#include "printing/operate/print_job.hpp"
#include "printing/twin/coarse_part.hpp"
#include "studio/print/paced_twin.hpp"

namespace pliant::studio {

class GrowingPart {
public:
    /// `job`: the one in that file.
    GrowingPart(std::filesystem::path file, const operate::ReadyJob& job);

    /// Starts anew for a new print.
    void clear();
    /// An exposure has ended, on a real machine. Called from the print's thread; only records it.
    void exposed(const host::Given& given);
    /// Recalls what an interrupted print has already exposed, from its journal. An unreadable journal is ignored.
    void recall(const std::filesystem::path& journal);
    /// Updates what has cured, exposure by exposure; `is_over`: no more exposures follow, the last layer is complete.
    void look_at(PacedTwin& twin, bool is_over);
    /// One image of the job, PNG. Errors: there is none.
    [[nodiscard]] Result<std::string> image(int layer, int material);
    /// {"type": "part", ...} if it has grown since the last call, else "".
    [[nodiscard]] std::string news();
    /// The slabs from `from` on, the last of which may still change; all of them if `revision` is not the current one.
    /// {"revision", "from", "closed", "cell_px", "height_mm", "kind": "cured" or "exposed"} and `slabs` (bottom and top
    /// of each, mm), `runs` (three numbers a run: slab | material << 24, row, begin | end << 16; in cells, slabs
    /// counted from the platform).
    [[nodiscard]] std::string packet(int revision, std::size_t from) const;

private:
    void take_exposed();
    void add_cured(const twin::CuredLayer& layer);
    [[nodiscard]] Result<job::Archive*> archive();
    [[nodiscard]] int revision() const { return revisions_before_ + part_.revision(); }

    std::filesystem::path file_;
    std::mutex archive_mutex_;
    std::unique_ptr<job::Archive> archive_;  ///< a separate one, opened when needed: the print uses the other
    std::mutex waiting_mutex_;               ///< guards what the print's thread hands over: it must never wait for
                                             ///< anything else
    std::deque<host::Given> waiting_;
    std::vector<std::pair<int, int>> heights_;  ///< bottom and top of the job's layers, um
    std::vector<int> material_of_vat_;

    mutable std::mutex mutex_;
    const twin::CoarsePart empty_;
    twin::CoarsePart part_;
    bool cured_ = false;                    ///< else exposed
    std::size_t seen_ = 0;                  ///< closed layers of the twin's block
    std::vector<std::size_t> lights_seen_;  ///< of the layer after them, by vat
    int revisions_before_ = 0;              ///< revisions used by earlier parts: numbers are never reused
    bool grown_ = false;
};

/// The slabs of a part from `from` on, in the format of GrowingPart::packet().
[[nodiscard]] std::string part_packet(const twin::CoarsePart& part, std::string_view kind, std::int64_t revision,
                                      std::size_t from);

/// The block compared with the drawing, for the report. The print must be over. Null if an image of the job cannot be
/// read.
[[nodiscard]] std::shared_ptr<const report::CuredBlock> block_of(PacedTwin& twin, const std::filesystem::path& file);

}  // namespace pliant::studio
