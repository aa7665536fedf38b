// A projector that is a folder: it shows the image `shown.png`; without that file it is dark. For `pliant twin
// --projector`.
#pragma once

#include <filesystem>

#include "printing/wire/devices.hpp"

namespace pliant::operate {

class PictureProjector final : public host::Projector {
public:
    explicit PictureProjector(std::filesystem::path folder) : folder_(std::move(folder)) {}
    ~PictureProjector() override;
    [[nodiscard]] Status show(const job::Image& image) override;
    [[nodiscard]] Status black() override;
    [[nodiscard]] std::filesystem::path shown() const { return folder_ / "shown.png"; }

private:
    std::filesystem::path folder_;
};

}  // namespace pliant::operate
