#include "simulation/material/law_parameters.hpp"

#include <fmt/format.h>

#include "simulation/material/point.hpp"

namespace pliant::material {
namespace {

struct Constant {
    std::string name, unit;
    double* value;
};
using Constants = std::vector<Constant>;

struct ConstantsOf {
    Constants operator()(NeoHookean& l) const {
        return {{"shear_modulus", "Pa", &l.shear_Pa}, {"bulk_modulus", "Pa", &l.bulk_Pa}};
    }
    Constants operator()(ShapeBlend& l) const { return {{"weight", "Pa", &l.weight_Pa}, {"a", "", &l.a}}; }
    Constants operator()(MooneyRivlin& l) const {
        return {{"c10", "Pa", &l.c10_Pa}, {"c01", "Pa", &l.c01_Pa}, {"bulk_modulus", "Pa", &l.bulk_Pa}};
    }
    Constants operator()(Yeoh& l) const {
        return {{"c10", "Pa", &l.c10_Pa},
                {"c20", "Pa", &l.c20_Pa},
                {"c30", "Pa", &l.c30_Pa},
                {"bulk_modulus", "Pa", &l.bulk_Pa}};
    }
    Constants operator()(Ogden& l) const {
        Constants all;
        for (int k = 0; k < l.terms; ++k) {
            all.push_back({fmt::format("mu_{}", k + 1), "Pa", &l.mu_Pa[k]});
            all.push_back({fmt::format("alpha_{}", k + 1), "", &l.alpha[k]});
        }
        all.push_back({"bulk_modulus", "Pa", &l.bulk_Pa});
        return all;
    }
    template <class Hookes>  // StVenantKirchhoff, Corotated, Linear
    Constants operator()(Hookes& l) const {
        return {{"shear_modulus", "Pa", &l.shear_Pa}, {"lame_lambda", "Pa", &l.lame_Pa}};
    }
};

Constants constants_of(Law& law) {
    return std::visit(ConstantsOf{}, law);
}

/// The law of the same kind with these moduli; empty if two moduli do not determine the law.
std::optional<Law> with_moduli(const Law& law, double E, double nu) {
    if (std::holds_alternative<NeoHookean>(law)) return neo_hookean(E, nu);
    if (std::holds_alternative<ShapeBlend>(law)) return shape_blend(E, nu);
    if (std::holds_alternative<StVenantKirchhoff>(law)) return st_venant_kirchhoff(E, nu);
    if (std::holds_alternative<Corotated>(law)) return corotated(E, nu);
    if (std::holds_alternative<Linear>(law)) return linear(E, nu);
    return std::nullopt;
}

/// Derivatives of the constants with respect to the moduli: the inverse of moduli(law), in closed form for all three
/// forms.
std::vector<double> direction_of(const Law& law, const Moduli& rate) {
    if (std::holds_alternative<NeoHookean>(law)) return {rate.shear_Pa, rate.bulk_Pa};
    if (const auto* blend = std::get_if<ShapeBlend>(&law)) {
        const double weight = 3 * rate.bulk_Pa;  // w = 3 K, a = 2 mu / w
        return {weight, (2 * rate.shear_Pa - blend->a * weight) / blend->weight_Pa};
    }
    return {rate.shear_Pa, rate.bulk_Pa - 2 * rate.shear_Pa / 3};
}

}  // namespace

std::vector<LawParameter> parameters(const Law& law) {
    Law copy = law;
    const Constants constants = constants_of(copy);
    std::vector<LawParameter> all;
    for (std::size_t k = 0; k < constants.size(); ++k) {
        all.push_back({constants[k].name, constants[k].unit, *constants[k].value, std::vector(constants.size(), 0.0)});
        all.back().direction[k] = 1;
    }
    const Moduli m = moduli(law);
    const double E = youngs_modulus(m), nu = poisson_ratio(m);
    if (!with_moduli(law, E, nu)) return all;
    all.push_back({"youngs_modulus", "Pa", E, direction_of(law, {m.shear_Pa / E, m.bulk_Pa / E})});
    all.push_back({"poisson_ratio", "", nu, direction_of(law, {-m.shear_Pa / (1 + nu), 2 * m.bulk_Pa / (1 - 2 * nu)})});
    return all;
}

Law with_parameter(const Law& law, std::size_t k, double value) {
    Law changed = law;
    const Constants constants = constants_of(changed);
    if (k < constants.size()) {
        *constants[k].value = value;
        return changed;
    }
    const Moduli m = moduli(law);
    const bool youngs = k == constants.size();
    return *with_moduli(law, youngs ? value : youngs_modulus(m), youngs ? poisson_ratio(m) : value);
}

std::vector<Matrix3> stress_by_constants(const Law& law, const Matrix3& F) {
    return std::visit([&](const auto& l) { return stress_slopes(l, F); }, law);
}

Moduli moduli_rate(const Law& law, const std::vector<double>& direction) {
    struct Of {
        const std::vector<double>& d;
        Moduli operator()(const NeoHookean&) const { return {d[0], d[1]}; }
        Moduli operator()(const ShapeBlend& l) const { return {(d[0] * l.a + l.weight_Pa * d[1]) / 2, d[0] / 3}; }
        Moduli operator()(const MooneyRivlin&) const { return {2 * (d[0] + d[1]), d[2]}; }
        Moduli operator()(const Yeoh&) const { return {2 * d[0], d[3]}; }
        Moduli operator()(const Ogden& l) const {
            double shear = 0;
            for (int k = 0; k < l.terms; ++k) shear += d[2 * static_cast<std::size_t>(k)];
            return {shear, d.back()};
        }
        Moduli operator()(const StVenantKirchhoff&) const { return {d[0], d[1] + 2 * d[0] / 3}; }
        Moduli operator()(const Corotated&) const { return {d[0], d[1] + 2 * d[0] / 3}; }
        Moduli operator()(const Linear&) const { return {d[0], d[1] + 2 * d[0] / 3}; }
    };
    return std::visit(Of{direction}, law);
}

}  // namespace pliant::material
