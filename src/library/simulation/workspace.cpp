#include "pliant/workspace.hpp"

#include <fmt/format.h>

#include <iterator>
#include <system_error>
#include <utility>

#include "base/core/checkpoint_folder.hpp"
#include "base/core/counted.hpp"
#include "base/core/digest.hpp"
#include "base/core/files.hpp"
#include "library/base/calls.hpp"
#include "library/simulation/data.hpp"
#include "library/simulation/steering.hpp"
#include "presentation/report/workspace_results.hpp"
#include "simulation/inverse/workspace_record.hpp"
#include "simulation/run/simulate.hpp"
#include "simulation/scene/build_goals.hpp"
#include "simulation/stepper/state_file.hpp"

namespace pliant {
namespace {

namespace fs = std::filesystem;

/// A file that says of which search the pieces are; a folder with it is a checkpoint.
constexpr const char* origin_name = "origin";

/// The completed pieces, in a folder with an identification of the search, in which no other process works meanwhile.
class KeptPieces {
public:
    static KeptPieces create(const fs::path& folder, const std::string& origin) {
        KeptPieces kept(library::value_of(CheckpointFolder::create(folder, origin_name)), origin);
        library::check(kept.folder_.write(origin_name, origin));
        return kept;
    }
    static KeptPieces open(const fs::path& folder, const std::string& origin) {
        std::error_code code;
        if (!fs::exists(folder / origin_name, code))
            throw Failure(Failure::Kind::input, folder.string() + ": holds no search to go on with", folder.string());
        KeptPieces kept(library::value_of(CheckpointFolder::open(folder, origin_name)), origin);
        if (library::value_of(read_file(folder / origin_name)) != origin)
            throw Failure(
                Failure::Kind::input,
                folder.string() +
                    ": is of another robot file, or a file that it names, the options or Pliant have changed since",
                folder.string());
        return kept;
    }

    /// None where it is missing, damaged or of another search: it is solved anew.
    [[nodiscard]] std::optional<sim::inverse::WorkspacePiece> read(std::size_t k) const {
        const Result<std::string> bytes = read_file(folder_.path() / file_of(k));
        if (!bytes) return std::nullopt;
        auto piece = sim::inverse::piece_from_bytes(*bytes, identity_of(k));
        return piece ? std::optional(std::move(*piece)) : std::nullopt;
    }
    /// Of the pieces that can be read.
    [[nodiscard]] std::size_t sample_count() const {
        std::size_t count = 0;
        for (std::size_t k = 0; has(k); ++k) {
            if (const auto piece = read(k)) count += piece->samples.size();
        }
        return count;
    }
    [[nodiscard]] Status write(std::size_t k, const sim::inverse::WorkspacePiece& piece) const {
        return folder_.write(file_of(k), sim::inverse::piece_bytes(piece, identity_of(k)));
    }

private:
    KeptPieces(CheckpointFolder folder, const std::string& origin) : folder_(std::move(folder)) {
        Digest digest;
        digest.add(origin.data(), origin.size());
        search_ = digest.text();
    }
    [[nodiscard]] static std::string file_of(std::size_t k) { return fmt::format("piece_{:04}", k); }
    /// They are written in their order.
    [[nodiscard]] bool has(std::size_t k) const {
        std::error_code code;
        return fs::exists(folder_.path() / file_of(k), code);
    }
    [[nodiscard]] std::string identity_of(std::size_t k) const { return fmt::format("{} {}", search_, k); }

    CheckpointFolder folder_;
    std::string search_;
};

/// A search that was interrupted may have taken hours: one forgotten option does not throw it away. What cannot be
/// resumed is left to KeptPieces::create(). `all`: the number of samples of the whole search.
void refuse_to_replace_samples(const fs::path& folder, const std::string& origin, std::size_t all) {
    if (const Result<std::string> there = read_file(folder / origin_name); !there || *there != origin) return;
    const std::size_t kept = KeptPieces::open(folder, origin).sample_count();
    if (kept == 0 || kept >= all) return;
    throw Failure(Failure::Kind::input,
                  fmt::format("{}: holds {} of {} of this search, which a new search would delete; resume it, or "
                              "remove the folder",
                              folder.string(), kept, counted(all, "sample")),
                  folder.string());
}

std::optional<KeptPieces> open_pieces(const Model::Data& model, const sim::InverseTask& task,
                                      const WorkspaceOptions& options) {
    if (options.checkpoint.empty()) {
        if (options.resume)
            throw Failure(Failure::Kind::input, "a search is to be gone on with, but no checkpoint is named");
        return std::nullopt;
    }
    // 3: pieces with a checksum, the search that they are of, and why they lack samples.
    const std::string origin = fmt::format("workspace 3\n{} {}\n{}\n{}", options.side, options.between,
                                           model.robot->origin(), sim::mesh_digest(model.scene.model.mesh()));
    if (options.resume) return KeptPieces::open(options.checkpoint, origin);
    refuse_to_replace_samples(options.checkpoint, origin,
                              sim::inverse::sample_count(task, {options.side, options.between}));
    return KeptPieces::create(options.checkpoint, origin);
}

void check_options(const WorkspaceOptions& options) {
    constexpr int most_places = 1000, most_between = 1000000;
    if (options.side < 2 || options.side > most_places)
        throw Failure(Failure::Kind::input, fmt::format("{} places along each input are not possible; 2 to {} are",
                                                        options.side, most_places));
    if (options.between < 0 || options.between > most_between)
        throw Failure(Failure::Kind::input, fmt::format("{} inputs between the sheets are not possible; 0 to {} are",
                                                        options.between, most_between));
}

[[noreturn]] void no_sample(std::size_t index, std::size_t count) {
    throw Failure(Failure::Kind::input, fmt::format("there is no sample {}; there are {}", index, count));
}

}  // namespace

struct Workspace::Data {
    std::shared_ptr<const Model::Data> model;
    sim::InverseTask task;
    sim::inverse::Workspace found;
    std::vector<SteeredInput> inputs;
    std::vector<std::pair<std::size_t, const sim::inverse::WorkspaceSample*>> samples;  ///< with their piece
    std::string message;
    std::vector<std::string> warnings;
    fs::path checkpoint;
    std::shared_ptr<const sim::Equilibrium> system;

    [[nodiscard]] report::WorkspaceReport report() const {
        return {model->scene.robot.name, model->scene.model, task, found};
    }
};

Workspace workspace(const Model& model, const WorkspaceOptions& options, const Watch& watch) {
    check_options(options);
    const robot::Scene& scene = model.data()->scene;
    sim::InverseTask task = library::value_of(robot::build_goals(scene.robot, scene.model, false));
    library::check(sim::inverse::check_samples(task, {options.side, options.between}));
    const std::optional<KeptPieces> kept = open_pieces(*model.data(), task, options);
    library::WatchedProgress progress(watch, "workspace");
    auto found = sim::inverse::find_workspace(
        scene.model, sim::stepper_options(scene.robot.program), task, {options.side, options.between},
        [&](std::size_t k) { return kept ? kept->read(k) : std::nullopt; },
        [&](std::size_t k, const auto& piece) { return kept ? kept->write(k, piece) : Status(); }, progress);
    progress.rethrow();
    auto data = std::make_shared<Workspace::Data>();
    data->found = library::value_of(std::move(found));
    if (data->found.cancelled) library::check(cancelled());
    data->message = sim::inverse::why_nothing_is_found(data->found);
    data->model = model.data();
    data->task = std::move(task);
    data->inputs = library::steered_inputs(scene.model, data->task);
    data->checkpoint = options.checkpoint;
    data->system = std::make_shared<const sim::Equilibrium>(scene.model);
    for (std::size_t p = 0; p < data->found.pieces.size(); ++p) {
        for (const sim::inverse::WorkspaceSample& sample : data->found.pieces[p].samples)
            data->samples.emplace_back(p, &sample);
    }
    data->warnings = report::workspace_warnings(data->report());
    return Workspace(std::move(data));
}

Workspace::Workspace(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

const std::vector<SteeredInput>& Workspace::inputs() const {
    return data_->inputs;
}
const std::string& Workspace::message() const {
    return data_->message;
}
const std::vector<std::string>& Workspace::warnings() const {
    return data_->warnings;
}
std::size_t Workspace::sample_count() const {
    return data_->samples.size();
}

WorkspaceSample Workspace::sample(std::size_t index) const {
    if (index >= sample_count()) no_sample(index, sample_count());
    const auto& [piece, sample] = data_->samples[index];
    return {piece,
            sample->values,
            sample->found,
            library::points_of(sample->markers),
            sample->tensions_N,
            sample->pressures_Pa};
}

Inputs Workspace::inputs_at(std::size_t index) const {
    if (index >= sample_count()) no_sample(index, sample_count());
    return library::inputs_at(*data_->system, data_->task, data_->samples[index].second->values,
                              data_->task.times.back());
}

Surface Workspace::sheets(std::size_t marker) const {
    const std::size_t markers = data_->model->scene.model.description().markers.size();
    if (marker >= markers)
        throw Failure(Failure::Kind::input, fmt::format("there is no marker {}; there are {}", marker, markers));
    const mesh::TriMesh surface = report::workspace_surface(data_->found, marker);
    return {library::points_of(surface.points), surface.triangles};
}

std::string Workspace::json() const {
    return report::workspace_json(data_->report());
}

void Workspace::write(const fs::path& folder, const Watch& watch) const {
    data_->model->robot->check_outside(folder);
    library::WatchedProgress progress(watch, "results");
    const Status written = report::write_workspace(folder, data_->model->scene.robot, data_->report(), progress);
    progress.rethrow();
    library::check(written);
}

void Workspace::remove_checkpoint() const {
    if (data_->checkpoint.empty()) return;
    library::check(CheckpointFolder::released(data_->checkpoint, origin_name).remove());
}

}  // namespace pliant
