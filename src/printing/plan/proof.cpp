#include "printing/plan/proof.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "printing/machine/gcode.hpp"
#include "printing/plan/check.hpp"
#include "printing/plan/passage.hpp"

namespace pliant::plan {
namespace {

using machine::Axis;
using machine::Expose;
using machine::Printer;

constexpr double light_tolerance_s = 1e-3;  // exposures are written in whole milliseconds

Status in_layer(std::size_t layer, const Status& status) {
    if (status) return status;
    return tl::unexpected(Error{status.error().cause, fmt::format("layer {}: {}", layer + 1, status.error().message)});
}

/// The content of every vat, including the plan's refills.
class Fillings {
public:
    Fillings(const Plan& plan, const job::Manifest& job, const Printer& printer) : job_(job), printer_(printer) {
        for (const machine::Vat& vat : printer.vats) left_ml_.push_back(usable_ml(vat));
        for (const RefillBefore& refill : plan.refills) refills_.emplace(refill.layer, refill.slot);
    }

    /// Image `k` of the layer is printed from the vat.
    Status draw(std::size_t layer, std::size_t k, std::size_t vat) {
        const machine::Vat& from = printer_.vats[vat];
        double& left_ml = left_ml_[vat];
        if (refills_.erase({static_cast<int>(layer), from.slot}) > 0) left_ml = usable_ml(from);
        left_ml -= image_ml(layer, job_.layers[layer].images[k]);
        if (left_ml >= -1e-6 * (1 + usable_ml(from))) return {};
        return input_error("the vat of slot {} has run dry: it gives {} of \"{}\"", from.slot, ml_text(usable_ml(from)),
                           from.resin);
    }

private:
    [[nodiscard]] double usable_ml(const machine::Vat& vat) const {
        return std::max(0.0, vat.fill_ml - printer_.vat_shape.least_ml);
    }
    [[nodiscard]] double image_ml(std::size_t layer, const job::LayerImage& image) const {
        return image.area_mm2 * job_.layers[layer].thickness_um / 1e6;
    }

    const job::Manifest& job_;
    const Printer& printer_;
    std::vector<double> left_ml_;
    std::set<std::pair<int, int>> refills_;  ///< layer and slot
};

/// The previous exposure.
struct LastLight {
    std::size_t layer = 0;
    int vat = 0;
};

/// Checks a program from exposure to exposure. `printer` has the resins that the plan fills in.
class Proof {
public:
    Proof(const Plan& plan, const job::Manifest& job, const Printer& printer)
        : job_(job), printer_(printer), fillings_(plan, job, printer), passage_(printer) {}

    Status step(const Step& step) {
        passage_.add(step);
        if (step.command != nullptr) {
            note_motors(*step.command);
            return check_switch(*step.command);
        }
        if (step.directive->stop_command) return add_stop(*step.directive->stop_command);
        if (!step.directive->expose) return {};
        const Expose& light = *step.directive->expose;
        const auto layer = static_cast<std::size_t>(light.layer);
        if (Status status = check_image(light); !status) return in_layer(layer, status);
        if (Status status = check_turn(light); !status) return status;
        if (Status status = check_place(light, *step.machine); !status) return in_layer(layer, status);
        if (Status status = check_rest(); !status) return in_layer(layer, status);
        if (Status status = check_way(light, *step.machine); !status) return status;
        last_ = LastLight{layer, *step.machine->hooked_vat()};
        passage_.restart(job_.layers[layer].z_um);
        return {};
    }

    /// Call after the last line.
    Status finish(const machine::Interlock& end) {
        if (Status status = check_complete(job_.layers.size()); !status) return status;
        if (last_) {
            if (Status status = passage_.check_peel(job_.layers[last_->layer].z_um); !status)
                return in_layer(last_->layer, status);
            if (printer_.store() != machine::Store::none) {
                if (Status status = passage_.check_brush(); !status) return status;
                if (Status status = passage_.check_cleaning(printer_.cleaning.spray_s); !status) return status;
            }
        }
        return check_end(end);
    }

private:
    [[nodiscard]] const job::Layer& layer_of(const Expose& light) const {
        return job_.layers[static_cast<std::size_t>(light.layer)];
    }
    [[nodiscard]] const std::string& material_name(int material) const {
        return job_.materials[static_cast<std::size_t>(material)].name;
    }

    /// Index of the material's image in its layer; the number of images if it has none.
    [[nodiscard]] static std::size_t index_of(const job::Layer& layer, int material) {
        const auto found = std::find_if(layer.images.begin(), layer.images.end(),
                                        [&](const job::LayerImage& image) { return image.material == material; });
        return static_cast<std::size_t>(found - layer.images.begin());
    }

    /// The exposure is in the manifest.
    [[nodiscard]] Status check_image(const Expose& light) const {
        if (static_cast<std::size_t>(light.layer) >= job_.layers.size())
            return input_error("the job has {} layers, counted from 0", job_.layers.size());
        const job::Layer& layer = layer_of(light);
        const std::size_t k = index_of(layer, light.material);
        if (k == layer.images.size()) {
            const bool known = static_cast<std::size_t>(light.material) < job_.materials.size();
            return input_error("nothing of {} is in this layer",
                               known ? fmt::format("\"{}\"", material_name(light.material))
                                     : fmt::format("material {}", light.material));
        }
        const std::string& name = material_name(light.material);
        if (layer.images[k].file != light.image)
            return input_error("exposure of \"{}\": shows {}, the manifest has {}", name, light.image,
                               layer.images[k].file);
        const double asked_s = job::exposure_s(job_, static_cast<std::size_t>(light.layer), k);
        if (std::abs(light.seconds - asked_s) > light_tolerance_s)
            return input_error("exposure of \"{}\": lasts {:g} s, the manifest says {:g} s", name, light.seconds,
                               asked_s);
        return {};
    }

    /// The exposure occurs once, and after all of the layers below.
    Status check_turn(const Expose& light) {
        const auto layer = static_cast<std::size_t>(light.layer);
        const std::string& name = material_name(light.material);
        if (layer < open_layer_)
            return input_error("layer {}: exposure of \"{}\" after layer {}", layer + 1, name, open_layer_ + 1);
        if (layer > open_layer_) {
            if (Status status = check_complete(layer); !status) return status;
            open_layer_ = layer;
            lit_.clear();
        }
        if (!lit_.insert(light.material).second)
            return input_error("layer {}: exposure of \"{}\" a second time", layer + 1, name);
        return {};
    }

    /// All exposures from the open layer to the one before `end` have been given.
    [[nodiscard]] Status check_complete(std::size_t end) const {
        for (std::size_t layer = open_layer_; layer < end; ++layer) {
            for (const job::LayerImage& image : job_.layers[layer].images) {
                if (layer != open_layer_ || !lit_.contains(image.material))
                    return input_error("layer {}: the exposure of \"{}\" is missing", layer + 1,
                                       material_name(image.material));
            }
        }
        return {};
    }

    /// The platform's height and the vat below it are right.
    Status check_place(const Expose& light, const machine::Interlock& machine) {
        const job::Layer& layer = layer_of(light);
        const std::string& name = material_name(light.material);
        const int at_um = machine.position()[Axis::platform];
        if (at_um != layer.z_um)
            return input_error("exposure of \"{}\": the platform stands at {:.3f} mm, the layer's height is {:.3f} mm",
                               name, at_um / 1000.0, layer.z_um / 1000.0);
        const auto vat = static_cast<std::size_t>(*machine.hooked_vat());
        const std::string& asked = job_.materials[static_cast<std::size_t>(light.material)].resin;
        const machine::Vat& used = printer_.vats[vat];
        if (used.resin != asked)
            return input_error("exposure of \"{}\": over the vat of slot {} with \"{}\", its resin is \"{}\"", name,
                               used.slot, used.resin, asked);
        return fillings_.draw(static_cast<std::size_t>(light.layer), index_of(layer, light.material), vat);
    }

    void note_motors(const machine::Command& command) {
        if ((command.is('M', 84) || command.is('M', 18)) && command.has('S'))
            motors_stay_ = command.value('S').value_or(0) == 0;
    }

    /// Forbidden during an exposure: idle motors, which would let the platform sink, and fans, which would move the
    /// resin.
    [[nodiscard]] Status check_rest() const {
        if (!motors_stay_) return input_error("motors may switch off during the exposure: M84 S0 before it is missing");
        if (passage_.fans_run()) return input_error("a fan runs during the exposure");
        return {};
    }

    /// Checks the machine's actions since the previous exposure.
    [[nodiscard]] Status check_way(const Expose& light, const machine::Interlock& machine) const {
        const auto layer = static_cast<std::size_t>(light.layer);
        const int vat = *machine.hooked_vat();
        if (last_ && last_->layer == layer && last_->vat == vat) return {};
        if (last_) {
            if (Status status = passage_.check_peel(job_.layers[last_->layer].z_um); !status)
                return in_layer(last_->layer, status);
            if (last_->vat != vat) {
                if (Status status = passage_.check_brush(); !status) return in_layer(layer, status);
                if (Status status = passage_.check_cleaning(printer_.cleaning_s(last_->vat, vat)); !status)
                    return in_layer(layer, status);
            }
        }
        return in_layer(layer, passage_.check_approach(job_.layers[layer].z_um));
    }

    [[nodiscard]] std::vector<machine::Switch> switches() const {
        std::vector<machine::Switch> all = printer_.fans;
        all.push_back(printer_.pump);
        return all;
    }

    /// A device is switched on with the value in the printer file.
    [[nodiscard]] static Status check_value(const machine::Switch& device, const machine::Command& command) {
        const auto own = machine::parse_command(device.on);
        constexpr double full = 255;  // if no value is given
        if (!own || own->value('S').value_or(full) == command.value('S').value_or(full)) return {};
        return input_error("a switch is not set as the printer file says, {}", device.on);
    }

    /// A device that is switched on can be stopped, and its value is that of the printer file.
    [[nodiscard]] Status check_switch(const machine::Command& command) const {
        for (const machine::Switch& device : {printer_.hooks.magnet.coil, printer_.wall.fork}) {
            if (machine::switched(device, command) != true) continue;
            if (Status status = check_value(device, command); !status) return status;
        }
        for (const machine::Switch& device : switches()) {
            if (machine::switched(device, command) != true) continue;
            if (Status status = check_value(device, command); !status) return status;
            if (!stops(device)) return input_error("{} has no line \";@stop {}\" before it", device.on, device.off);
        }
        return {};
    }

    [[nodiscard]] bool stops(const machine::Switch& device) const {
        return std::any_of(stops_.begin(), stops_.end(), [&](const machine::Command& command) {
            return machine::switched(device, command) == false;
        });
    }

    /// Commands for a stop may only switch something off.
    Status add_stop(const std::string& text) {
        const auto command = machine::parse_command(text);
        if (!command) return tl::unexpected(command.error());
        const std::vector<machine::Switch> all = switches();
        const bool off = std::any_of(all.begin(), all.end(), [&](const machine::Switch& device) {
            return machine::switched(device, *command) == false;
        });
        if (!off) return input_error(";@stop {}: switches nothing of {} off", text, printer_.name);
        stops_.push_back(*command);
        return {};
    }

    [[nodiscard]] Status check_end(const machine::Interlock& end) const {
        if (end.pump_runs()) return input_error("the program ends with the pump running");
        if (passage_.fans_run()) return input_error("the program ends with a fan running");
        if (printer_.has_carriage()) {
            for (std::size_t v = 0; v < printer_.vats.size(); ++v) {
                const int slot = printer_.vats[v].slot;
                if (end.vat_in_slot(slot) != static_cast<int>(v))
                    return input_error("the program ends with the vat of slot {} out of its place", slot);
            }
        }
        const int clear_um = printer_.clear_um(end.part_height_um());
        if (last_ && end.position()[Axis::platform] < clear_um)
            return input_error("the program ends with the platform at {:.3f} mm, the part is clear from {:.3f} mm",
                               end.position()[Axis::platform] / 1000.0, clear_um / 1000.0);
        return {};
    }

    const job::Manifest& job_;
    const Printer& printer_;
    Fillings fillings_;
    Passage passage_;
    std::optional<LastLight> last_;
    bool motors_stay_ = false;  ///< M84 S0: even when idle
    std::size_t open_layer_ = 0;
    std::set<int> lit_;  ///< materials of the open layer
    std::vector<machine::Command> stops_;
};

}  // namespace

Status prove_program(std::string_view gcode, const Plan& plan, const job::Manifest& job, const Printer& printer) {
    const Printer filled = filled_printer(plan, job, printer);
    Proof proof(plan, job, filled);
    int last_line = 0;
    const auto watch = [&](const Step& step) {
        last_line = step.line;
        return proof.step(step);
    };
    const auto end = replay_gcode(gcode, filled, std::numeric_limits<int>::max(), watch);
    if (!end) return tl::unexpected(end.error());
    const Status finished = proof.finish(*end);
    if (finished) return {};
    return tl::unexpected(Error{finished.error().cause,
                                fmt::format("G-code line {}, the last: {}", last_line, finished.error().message)});
}

}  // namespace pliant::plan
