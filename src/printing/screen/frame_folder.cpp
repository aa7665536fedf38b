#include "printing/screen/frame_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/core/files.hpp"
#include "base/core/parse_all.hpp"
#include "printing/job/png.hpp"

namespace pliant::host {
namespace {

constexpr const char* shown_name = "shown.png";

/// The highest number of an image that an earlier process has kept; 0: none.
Result<int> last_kept(const std::filesystem::path& folder) {
    constexpr int most = 1'000'000'000;
    int last = 0;
    std::error_code error;
    for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
        const std::filesystem::path name = entry->path().filename();
        int number = 0;
        const bool is_kept = name.extension() == ".png" && parse_all(name.stem().string(), number);
        if (is_kept && number <= most) last = std::max(last, number);
    }
    if (error) return input_error("{}: {}", folder.string(), error.message());
    return last;
}

}  // namespace

Result<FrameFolder> FrameFolder::open(const std::filesystem::path& folder, int width_px, int height_px) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) return input_error("{}: {}", folder.string(), error.message());
    std::filesystem::remove(folder / shown_name, error);
    if (error) return input_error("{}: {}", (folder / shown_name).string(), error.message());
    const Result<int> kept = last_kept(folder);
    if (!kept) return tl::unexpected(kept.error());
    return FrameFolder(folder, width_px, height_px, *kept);
}

FrameFolder::FrameFolder(FrameFolder&& other) noexcept
    : folder_(std::exchange(other.folder_, {})),
      width_px_(other.width_px_),
      height_px_(other.height_px_),
      shown_(other.shown_),
      lit_(std::exchange(other.lit_, nullptr)),
      pacer_(std::move(other.pacer_)) {}

FrameFolder::~FrameFolder() {
    if (lit_ != nullptr) (void)put_out();
}

/// Renaming `shown.png` makes the panel dark.
Status FrameFolder::put_out() {
    std::error_code error;
    std::filesystem::rename(folder_ / shown_name, folder_ / fmt::format("{:05}.png", shown_), error);
    if (error) std::filesystem::remove(folder_ / shown_name, error);
    lit_ = nullptr;
    if (error) return failure("{}: {}", (folder_ / shown_name).string(), error.message());
    return {};
}

Result<double> FrameFolder::present(const job::Image* image) {
    pacer_.wait();
    if (lit_ != nullptr && lit_ != image) {
        if (Status status = put_out(); !status) return tl::unexpected(status.error());
    }
    if (image != nullptr && lit_ == nullptr) {
        if (Status status = write_file(folder_ / shown_name, job::encode_png(*image)); !status)
            return tl::unexpected(status.error());
        lit_ = image;
        ++shown_;
    }
    return pacer_.mark();
}

}  // namespace pliant::host
