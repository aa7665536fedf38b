#include "robot/description/law.hpp"

#include <algorithm>

namespace pliant::material {

Moduli moduli(double youngs_modulus_Pa, double poisson_ratio) {
    return {youngs_modulus_Pa / (2 * (1 + poisson_ratio)), youngs_modulus_Pa / (3 * (1 - 2 * poisson_ratio))};
}

double bulk_modulus(double shear_Pa, double poisson_ratio) {
    return 2 * shear_Pa * (1 + poisson_ratio) / (3 * (1 - 2 * poisson_ratio));
}

double youngs_modulus(const Moduli& moduli) {
    return 9 * moduli.bulk_Pa * moduli.shear_Pa / (3 * moduli.bulk_Pa + moduli.shear_Pa);
}

double poisson_ratio(const Moduli& moduli) {
    return (3 * moduli.bulk_Pa - 2 * moduli.shear_Pa) / (6 * moduli.bulk_Pa + 2 * moduli.shear_Pa);
}

NeoHookean neo_hookean(double youngs_modulus_Pa, double poisson_ratio) {
    const Moduli m = moduli(youngs_modulus_Pa, poisson_ratio);
    return {m.shear_Pa, m.bulk_Pa};
}

StVenantKirchhoff st_venant_kirchhoff(double youngs_modulus_Pa, double poisson_ratio) {
    const Moduli m = moduli(youngs_modulus_Pa, poisson_ratio);
    return {m.shear_Pa, m.bulk_Pa - 2 * m.shear_Pa / 3};
}

Corotated corotated(double youngs_modulus_Pa, double poisson_ratio) {
    const Moduli m = moduli(youngs_modulus_Pa, poisson_ratio);
    return {m.shear_Pa, m.bulk_Pa - 2 * m.shear_Pa / 3};
}

Linear linear(double youngs_modulus_Pa, double poisson_ratio) {
    const Moduli m = moduli(youngs_modulus_Pa, poisson_ratio);
    return {m.shear_Pa, m.bulk_Pa - 2 * m.shear_Pa / 3};
}

ShapeBlend shape_blend(double youngs_modulus_Pa, double poisson_ratio) {
    const Moduli m = moduli(youngs_modulus_Pa, poisson_ratio);
    return {3 * m.bulk_Pa, (1 - 2 * poisson_ratio) / (1 + poisson_ratio)};
}

double shape_parameter_of_thesis(double material_ratio) {
    return (0.114 * material_ratio + 1.665) * material_ratio - 0.766;
}

double shape_parameter_small_strain(double material_ratio) {
    return (3 * material_ratio - 1) / 2;
}

std::optional<InvariantForm> invariant_form(const Law& law) {
    if (const auto* l = std::get_if<NeoHookean>(&law)) return InvariantForm{0.5 * l->shear_Pa, 0, 0, 0, l->bulk_Pa};
    if (const auto* l = std::get_if<MooneyRivlin>(&law)) return InvariantForm{l->c10_Pa, 0, 0, l->c01_Pa, l->bulk_Pa};
    if (const auto* l = std::get_if<Yeoh>(&law)) return InvariantForm{l->c10_Pa, l->c20_Pa, l->c30_Pa, 0, l->bulk_Pa};
    return std::nullopt;
}

bool has_energy(const Law& law) {
    const auto* blend = std::get_if<ShapeBlend>(&law);
    return blend == nullptr || blend->a == 1;
}

bool is_objective(const Law& law) {
    return !std::holds_alternative<Linear>(law);
}

Moduli moduli(const Law& law) {
    struct Of {
        Moduli operator()(const NeoHookean& l) const { return {l.shear_Pa, l.bulk_Pa}; }
        Moduli operator()(const ShapeBlend& l) const { return {l.weight_Pa * l.a / 2, l.weight_Pa / 3}; }
        Moduli operator()(const StVenantKirchhoff& l) const { return {l.shear_Pa, l.lame_Pa + 2 * l.shear_Pa / 3}; }
        Moduli operator()(const MooneyRivlin& l) const { return {2 * (l.c10_Pa + l.c01_Pa), l.bulk_Pa}; }
        Moduli operator()(const Yeoh& l) const { return {2 * l.c10_Pa, l.bulk_Pa}; }
        Moduli operator()(const Ogden& l) const {
            double shear = 0;
            for (int k = 0; k < l.terms; ++k) shear += l.mu_Pa[k];
            return {shear, l.bulk_Pa};
        }
        Moduli operator()(const Corotated& l) const { return {l.shear_Pa, l.lame_Pa + 2 * l.shear_Pa / 3}; }
        Moduli operator()(const Linear& l) const { return {l.shear_Pa, l.lame_Pa + 2 * l.shear_Pa / 3}; }
    };
    return std::visit(Of{}, law);
}

double stiffness_bound(const Law& law) {
    const Moduli m = moduli(law);
    return std::max(3 * m.bulk_Pa, 2 * m.shear_Pa);
}

std::string_view name(const Law& law) {
    struct Name {
        std::string_view operator()(const NeoHookean&) const { return "neo-hookean"; }
        std::string_view operator()(const ShapeBlend&) const { return "shape-blend"; }
        std::string_view operator()(const StVenantKirchhoff&) const { return "st-venant-kirchhoff"; }
        std::string_view operator()(const MooneyRivlin&) const { return "mooney-rivlin"; }
        std::string_view operator()(const Yeoh&) const { return "yeoh"; }
        std::string_view operator()(const Ogden&) const { return "ogden"; }
        std::string_view operator()(const Corotated&) const { return "corotated"; }
        std::string_view operator()(const Linear&) const { return "linear"; }
    };
    return std::visit(Name{}, law);
}

}  // namespace pliant::material
