#include "simulation/run/checkpoint.hpp"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <limits>
#include <system_error>
#include <utility>

#include "base/core/files.hpp"
#include "simulation/run/step_record.hpp"
#include "simulation/stepper/cbor_numbers.hpp"
#include "simulation/stepper/state_file.hpp"

namespace pliant::sim {
namespace {

using cbor::Json;
using cbor::Reader;
namespace fs = std::filesystem;

constexpr const char* format_name = "pliant checkpoint";
constexpr int version = 4;  // 2: friction with memory, objects; 3: joints; 4: checksums of steps
constexpr const char* steps_name = "steps";
constexpr const char* state_name = "state";

std::string length_bytes(std::uint64_t length) {
    std::string bytes(sizeof length, '\0');
    std::memcpy(bytes.data(), &length, sizeof length);
    return bytes;
}

Json json_of_checks(const ChecksState& checks) {
    return {{"reported_along", checks.reported.along},
            {"reported_x", cbor::packed(checks.reported.state.x)},
            {"reported_multiplier", cbor::packed(checks.reported.state.multiplier)},
            {"last_way", checks.last_way},
            {"before_jump", checks.before_jump},
            {"warned", checks.warned}};
}

/// Numbers below `end`.
std::vector<std::size_t> indices(Reader& in, const char* key, std::size_t end) {
    std::vector<std::size_t> out;
    const Json& list = in.at(key);
    if (!list.is_array()) in.fail(std::string(key) + " is not a list");
    for (const Json& one : list) {
        if (!one.is_number_unsigned() || one.get<std::uint64_t>() >= end) {
            in.fail(std::string(key) + " has an entry that is out of range");
            break;
        }
        out.push_back(one.get<std::size_t>());
    }
    return out;
}

ChecksState checks_from(Reader& in, const RobotState& robot, std::size_t steps, std::size_t cables) {
    ChecksState checks;
    checks.reported.along = in.number("reported_along");
    checks.reported.state.x = in.vector("reported_x", robot.x().size());
    checks.reported.state.multiplier = in.vector("reported_multiplier", robot.now.state.multiplier.size());
    checks.last_way = in.number("last_way");
    checks.before_jump = indices(in, "before_jump", steps);
    for (const std::size_t cable : indices(in, "warned", cables)) checks.warned.insert(cable);
    return checks;
}

/// Crossings are found later than the steps are written.
Json crossings_of(const std::vector<Step>& steps) {
    Json list = Json::array();
    for (std::size_t k = 0; k < steps.size(); ++k) {
        if (const auto& at = steps[k].crossing_m) list.push_back({k, at->x, at->y, at->z});
    }
    return list;
}

void take_crossings(Reader& in, std::vector<Step>& steps) {
    const Json& list = in.at("crossings");
    if (!list.is_array()) in.fail("crossings is not a list");
    for (const Json& one : list) {
        const bool good = one.is_array() && one.size() == 4 && one[0].is_number_unsigned() &&
                          one[0].get<std::uint64_t>() < steps.size() &&
                          std::all_of(one.begin(), one.end(), [](const Json& value) { return value.is_number(); });
        if (!good) return in.fail("crossings has an entry of another kind");
        steps[one[0].get<std::size_t>()].crossing_m = Vec3{one[1], one[2], one[3]};
    }
}

/// Reads the records of `count` consecutive steps.
Status read_steps(const fs::path& file, std::uintmax_t bytes, std::size_t count, std::size_t nodes, Trajectory& into) {
    std::error_code code;
    const std::uintmax_t size = fs::file_size(file, code);
    if (code || size < bytes) return input_error_at(file.string(), 0, "damaged: it is shorter than it was");
    std::ifstream in(file, std::ios::binary);
    std::uintmax_t left = bytes;
    for (std::size_t k = 0; k < count; ++k) {
        std::uint64_t length = 0;
        in.read(reinterpret_cast<char*>(&length), sizeof length);
        if (!in || left < sizeof length || length > left - sizeof length)
            return input_error_at(file.string(), 0, "damaged: it ends in step {}", k);
        left -= sizeof length + length;
        std::string record(length, '\0');
        in.read(record.data(), static_cast<std::streamsize>(length));
        if (!in) return input_error_at(file.string(), 0, "damaged: it ends in step {}", k);
        const Result<std::string_view> content = cbor::unsealed(record);
        if (!content) return input_error_at(file.string(), 0, "step {}: {}", k, content.error().message);
        auto step = step_from_bytes(*content, nodes);
        if (!step) return input_error_at(file.string(), 0, "step {}: {}", k, step.error().message);
        if (step->step.index != static_cast<int>(k))
            return input_error_at(file.string(), 0, "damaged: step {} is where step {} should be", step->step.index, k);
        into.steps.push_back(std::move(step->step));
        into.iterations.insert(into.iterations.end(), step->iterations.begin(), step->iterations.end());
    }
    return {};
}

}  // namespace

Result<Checkpoint> Checkpoint::create(const fs::path& folder, std::string origin, int every) {
    Result<CheckpointFolder> own = CheckpointFolder::create(folder, steps_name);
    if (!own) return tl::unexpected(own.error());
    if (Status status = own->write(steps_name, ""); !status) return tl::unexpected(status.error());
    return Checkpoint(std::move(*own), std::move(origin), every);
}

Status Checkpoint::keep(const Model& model, const RunState& run) {
    const Trajectory& all = run.so_far;
    const fs::path steps = folder_.path() / steps_name;
    std::ofstream file(steps, std::ios::binary | std::ios::app);
    std::uintmax_t bytes = bytes_;
    std::size_t iterations = iterations_;
    for (std::size_t k = steps_; k < all.steps.size(); ++k) {
        const auto end =
            std::find_if(all.iterations.begin() + static_cast<std::ptrdiff_t>(iterations), all.iterations.end(),
                         [&](const IterationRecord& r) { return r.step > all.steps[k].index; });
        const auto last = static_cast<std::size_t>(end - all.iterations.begin());
        const std::string record =
            cbor::sealed(step_bytes(all.steps[k], std::span(all.iterations).subspan(iterations, last - iterations)));
        file << length_bytes(record.size()) << record;
        bytes += sizeof(std::uint64_t) + record.size();
        iterations = last;
    }
    file.close();
    if (!file) return failure("{}: cannot be written; is the disk full?", steps.string());
    // Before the state that counts on them: a power cut may otherwise leave the state alone.
    if (Status status = folder_.sync(steps_name); !status) return status;
    const std::string robot = state_bytes(model, run.robot);
    const Json json{{"format", format_name},
                    {"version", version},
                    {"origin", origin_},
                    {"every", every_},
                    {"step", run.step},
                    {"steps", all.steps.size()},
                    {"bytes", bytes},
                    {"solver", all.solver},
                    {"warnings", all.warnings},
                    {"setup_s", all.setup_s},
                    {"solve_s", all.solve_s},
                    {"crossings", crossings_of(all.steps)},
                    {"checks", json_of_checks(run.checks)},
                    {"robot", Json::binary({robot.begin(), robot.end()})}};
    if (Status status = folder_.write(state_name, cbor::sealed(json)); !status) return status;
    bytes_ = bytes;
    steps_ = all.steps.size();
    iterations_ = iterations;
    return {};
}

Result<Checkpoint::Resumed> Checkpoint::open(const fs::path& folder, std::string origin, const Model& model,
                                             const Program& program) {
    const fs::path state = folder / state_name;
    std::error_code code;
    if (!fs::exists(state, code) && !fs::exists(folder / steps_name, code))
        return input_error_at(folder.string(), 0,
                              "no checkpoint is there; a run makes one where it is told to keep checkpoints");
    Result<CheckpointFolder> own = CheckpointFolder::open(folder, steps_name);
    if (!own) return tl::unexpected(own.error());
    if (!fs::exists(state, code))
        return input_error_at(folder.string(), 0,
                              "the run ended before its first checkpoint; there is nothing to resume");
    const auto text = read_file(state);
    if (!text) return tl::unexpected(text.error());
    const auto wrong = [&](const std::string& why) { return input_error_at(state.string(), 0, "{}", why); };
    const Result<std::string_view> content = cbor::unsealed(*text);
    const Json json = content ? cbor::parsed(*content) : Json();
    if (!json.is_object() || json.value("format", Json()) != format_name)
        return wrong("not a checkpoint that Pliant has written, or damaged");
    Reader in(json);
    const int own_version = in.integer("version", 0, std::numeric_limits<int>::max());
    if (in.status() && own_version != version)
        return wrong(fmt::format("a checkpoint of version {}; this Pliant reads version {}", own_version, version));
    if (in.text("origin") != origin && in.status())
        return wrong(
            "a checkpoint of another robot file, or the file, a file that it names, its changes or its solver have "
            "changed since");
    RunState run;
    run.step = in.integer("step", 0, program.steps);
    const int every = in.integer("every", 1, std::numeric_limits<int>::max());
    const auto bytes = static_cast<std::uintmax_t>(std::max(0.0, in.number("bytes")));
    run.so_far.solver = in.text("solver");
    run.so_far.setup_s = in.number("setup_s");
    run.so_far.solve_s = in.number("solve_s");
    for (const Json& warning : in.at("warnings")) {
        if (warning.is_string()) run.so_far.warnings.push_back(warning.get<std::string>());
    }
    const std::vector<char> robot = in.numbers<char>("robot");
    if (!in.status()) return wrong(in.status().error().message);
    const auto steps = static_cast<std::size_t>(run.step) + 1;
    const Stepper stepper(model, stepper_options(program));
    auto read = state_from_bytes(stepper, {robot.data(), robot.size()});
    if (!read) return wrong(read.error().message);
    run.robot = std::move(*read);
    Reader checks(in.at("checks"));
    run.checks = checks_from(checks, run.robot, steps, model.description().cables.size());
    if (!checks.status()) return wrong(checks.status().error().message);
    const auto nodes = static_cast<std::size_t>(model.node_count());
    if (Status status = read_steps(folder / steps_name, bytes, steps, nodes, run.so_far); !status)
        return tl::unexpected(status.error());
    take_crossings(in, run.so_far.steps);
    if (!in.status()) return wrong(in.status().error().message);
    fs::resize_file(folder / steps_name, bytes, code);
    if (code) return failure("{}: cannot be written: {}", (folder / steps_name).string(), code.message());
    Checkpoint checkpoint(std::move(*own), std::move(origin), every);
    checkpoint.bytes_ = bytes;
    checkpoint.steps_ = run.so_far.steps.size();
    checkpoint.iterations_ = run.so_far.iterations.size();
    return Resumed{std::move(checkpoint), std::move(run)};
}

}  // namespace pliant::sim
