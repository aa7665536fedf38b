#include "robot/file/material_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/core/text.hpp"
#include "robot/file/reading.hpp"

namespace pliant::robot {
namespace {

using config::Reader;

std::optional<std::array<double, 3>> read_colour(Reader& reader) {
    if (!reader.has("colour")) return (void)reader.raw("colour"), std::nullopt;
    const std::string text = reader.text("colour");
    std::array<double, 3> rgb{};
    bool good = text.size() == 7 && text[0] == '#';
    for (std::size_t i = 0; good && i < 3; ++i) {
        int value = 0;
        const char* first = text.data() + 1 + 2 * i;
        const auto [end, code] = std::from_chars(first, first + 2, value, 16);
        good = code == std::errc() && end == first + 2;
        rgb[i] = value / 255.0;
    }
    if (!good) reader.problem("colour", "write a colour as \"#rrggbb\"");
    return rgb;
}

/// False, and a problem, if no solid can have this Poisson ratio.
bool check_poisson_ratio(Reader& reader, double nu) {
    if (nu > -1 && nu < 0.5) return true;
    reader.problem("poisson_ratio",
                   fmt::format("{} is not possible; above -1 and below 0.5, rubber is 0.45 to 0.499", nu));
    return false;
}

/// The largest R_omega. A softer target shape keeps less than a thousandth of the rest shape: it resists only a change
/// of volume, so that the equilibrium shape is not unique and no solver converges.
constexpr double softest_R = 1000;

/// R_omega from a ratio of moduli, R_m >= 1, by the named map.
double shape_parameter_by(Reader& reader, const std::string& map, double R_m) {
    if (map == "calibrated") {
        const std::vector<double> c = reader.numbers("shape_curve", 3);
        if (c.size() != 3) return 1;
        const double R = (c[0] * R_m + c[1]) * R_m + c[2];
        if (!(R >= 1))
            reader.problem("shape_curve", fmt::format("gives R_omega {:.4g} for R_m {:.4g}; it is 1 or more", R, R_m));
        return std::max(1.0, R);
    }
    return map == "thesis" ? material::shape_parameter_of_thesis(R_m) : material::shape_parameter_small_strain(R_m);
}

/// R_omega from two moduli: that of the material, and that of the stiffest one, whose target is rigid and whose modulus
/// determines the common weight.
material::ShapeBlend read_named_blend(Reader& reader, double E) {
    const std::string map = reader.choice("shape_parameter", {"thesis", "small-strain", "calibrated"});
    if (map != "calibrated" && reader.has("shape_curve"))
        reader.problem("shape_curve", "goes with shape_parameter = \"calibrated\"");
    if (!reader.has("stiffest")) {
        reader.problem("stiffest", "is missing; Young's modulus of the material that counts as rigid, as \"45 MPa\"");
        return {1, 1};
    }
    const double stiffest = reader.quantity("stiffest", Dimension::pressure, E);
    if (reader.unreadable("youngs_modulus") || reader.unreadable("stiffest")) return {1, 1};
    if (!(stiffest >= E)) {
        reader.problem("stiffest", "is below youngs_modulus; the stiffest material counts as rigid");
        return {1, 1};
    }
    const double R = stiffest == E ? 1 : shape_parameter_by(reader, map, stiffest / E);
    if (!(R <= softest_R)) {
        reader.problem("stiffest", fmt::format("is {:.4g} times youngs_modulus, which takes R_omega {:.4g}; above {:g} "
                                               "hardly anything holds a shape. Bring the two nearer to each other",
                                               stiffest / E, R, softest_R));
        return {1, 1};
    }
    return {stiffest, 1 / R};
}

material::Law read_shape_blend(Reader& reader, MaterialSpec& material) {
    const double nu = material.poisson_ratio;
    const config::Value* given = reader.raw("shape_parameter");
    if (given != nullptr && std::holds_alternative<std::string>(given->data)) {
        // A poisson_ratio of the file is not used: with --set a law can be changed, but no key be taken away.
        const material::ShapeBlend blend = read_named_blend(reader, material.youngs_modulus_Pa);
        material.poisson_ratio = material::poisson_ratio(material::moduli(blend));
        return blend;
    }
    if (nu < 0) reader.problem("poisson_ratio", "the shape blend has no negative Poisson ratio");
    if (reader.has("stiffest")) {
        reader.problem("stiffest",
                       "goes with a shape_parameter by name: \"thesis\", \"small-strain\" or \"calibrated\"");
    }
    material::ShapeBlend blend = material::shape_blend(material.youngs_modulus_Pa, nu);
    if (given != nullptr) {
        // The thesis' convention: one weight for all materials, which differ in R_omega.
        const double R = reader.number("shape_parameter", 1);
        if (R >= 1 && R <= softest_R)
            blend.a = 1 / R;
        else
            reader.problem("shape_parameter",
                           fmt::format("{:g} is not possible; R_omega is from 1 (rigid) to {:g}, with 7.08 for "
                                       "materials of 45 and 12 MPa, and 50 for hardly more than a kept volume",
                                       R, softest_R));
    } else if (nu >= 0 && !(blend.a >= 1 / softest_R)) {
        reader.problem("poisson_ratio", fmt::format("{} leaves the shape blend nothing that holds a shape; at most "
                                                    "{:.5f}, rubber is 0.45 to 0.499",
                                                    nu, (softest_R - 1) / (2 * softest_R + 1)));
    }
    return blend;
}

/// The laws that are determined by Young's modulus and Poisson ratio.
void read_two_moduli(Reader& reader, const std::string& law, MaterialSpec& material) {
    const double nu = material.poisson_ratio = reader.number("poisson_ratio", 0.45);
    const double E = material.youngs_modulus_Pa = reader.has("youngs_modulus")
                                                      ? reader.quantity("youngs_modulus", Dimension::pressure, 1)
                                                      : reader.quantity("youngs_modulus", Dimension::pressure);
    if (!check_poisson_ratio(reader, nu)) return;
    if (reader.has("youngs_modulus") && !(E > 0)) reader.problem("youngs_modulus", "must be above zero");
    if (law == "neo-hookean") material.law = material::neo_hookean(E, nu);
    if (law == "st-venant-kirchhoff") material.law = material::st_venant_kirchhoff(E, nu);
    if (law == "corotated") material.law = material::corotated(E, nu);
    if (law == "linear") material.law = material::linear(E, nu);
    if (law == "shape-blend") material.law = read_shape_blend(reader, material);
}

/// The given bulk modulus, or that from the small-strain Poisson ratio. Precondition: shear_Pa > 0.
double read_bulk(Reader& reader, double shear_Pa) {
    if (!reader.has("bulk_modulus")) {
        (void)reader.raw("bulk_modulus");
        const double nu = reader.number("poisson_ratio", 0.45);
        return check_poisson_ratio(reader, nu) ? material::bulk_modulus(shear_Pa, nu) : shear_Pa;
    }
    if (reader.has("poisson_ratio"))
        reader.problem("poisson_ratio", "stands beside bulk_modulus; one of the two determines the other");
    const double K = reader.quantity("bulk_modulus", Dimension::pressure, shear_Pa);
    if (!(K > 0)) reader.problem("bulk_modulus", "must be above zero");
    return K > 0 ? K : shear_Pa;
}

double pressure(Reader& reader, std::string_view key) {
    return reader.quantity(key, Dimension::pressure);
}

std::optional<material::Ogden> read_ogden(Reader& reader) {
    material::Ogden law{};
    const std::vector<std::string> mu = reader.texts("mu");
    const std::vector<double> alpha = reader.numbers("alpha");
    if (!reader.has("mu")) reader.problem("", "\"mu\" is missing; it is a list of pressures such as [\"1.2 MPa\"]");
    if (mu.empty() || mu.size() != alpha.size() || mu.size() > material::Ogden::most_terms) {
        if (!reader.unreadable("alpha"))
            reader.problem("mu", fmt::format("has {} values and alpha {}; as many of each, 1 to {}", mu.size(),
                                             alpha.size(), material::Ogden::most_terms));
        return std::nullopt;
    }
    law.terms = static_cast<int>(mu.size());
    for (std::size_t k = 0; k < mu.size(); ++k) {
        const Result<double> value = parse_quantity(mu[k], Dimension::pressure);
        if (!value) return reader.problem("mu", value.error().message), std::nullopt;
        law.mu_Pa[k] = *value;
        law.alpha[k] = alpha[k];
        if (alpha[k] == 0 || !(std::fabs(alpha[k]) <= 100))
            reader.problem("alpha", fmt::format("{} is not possible; between -100 and 100, and not zero", alpha[k]));
    }
    return law;
}

/// The constants only, with the bulk modulus still zero. Empty if one of them could not be read.
std::optional<material::Law> read_constants(Reader& reader, const std::string& law) {
    std::optional<material::Law> constants;
    if (law == "mooney-rivlin") constants = material::MooneyRivlin{pressure(reader, "c10"), pressure(reader, "c01"), 0};
    if (law == "ogden") constants = read_ogden(reader);
    if (law == "yeoh")
        constants = material::Yeoh{pressure(reader, "c10"), reader.quantity("c20", Dimension::pressure, 0),
                                   reader.quantity("c30", Dimension::pressure, 0), 0};
    for (const char* key : {"c10", "c01", "c20", "c30", "mu", "alpha"}) {
        if (reader.unreadable(key)) return std::nullopt;
    }
    return constants;
}

std::string_view shear_formula(const std::string& law) {
    if (law == "mooney-rivlin") return "2 (c10 + c01)";
    return law == "ogden" ? "the sum of mu" : "2 c10";
}

/// The laws with constants of their own.
void read_hyperelastic(Reader& reader, const std::string& law, MaterialSpec& material) {
    if (reader.has("youngs_modulus")) {
        reader.problem("youngs_modulus",
                       fmt::format("does not determine the constants of \"{}\"; give them, its initial shear modulus "
                                   "is {}, or take law = \"neo-hookean\"",
                                   law, shear_formula(law)));
        (void)read_constants(reader, law);
        (void)reader.raw("poisson_ratio");
        return;
    }
    const std::optional<material::Law> constants = read_constants(reader, law);
    const double shear = constants ? material::moduli(*constants).shear_Pa : 1;
    if (!(shear > 0))
        reader.problem(law == "ogden" ? "mu" : "c10", fmt::format("the initial shear modulus, {}, is {:.4g} "
                                                                  "MPa; a stable solid needs one above zero",
                                                                  shear_formula(law), shear / 1e6));
    const double K = read_bulk(reader, shear > 0 ? shear : 1);
    material.has_bulk_modulus = reader.has("bulk_modulus");
    if (!constants) return;
    material::Law elastic = *constants;
    if (auto* l = std::get_if<material::MooneyRivlin>(&elastic)) l->bulk_Pa = K;
    if (auto* l = std::get_if<material::Yeoh>(&elastic)) l->bulk_Pa = K;
    if (auto* l = std::get_if<material::Ogden>(&elastic)) l->bulk_Pa = K;
    material.law = elastic;
    material.youngs_modulus_Pa = material::youngs_modulus(material::moduli(elastic));
    material.poisson_ratio = material::poisson_ratio(material::moduli(elastic));
}

struct ConstantOfLaws {
    std::string_view key;
    std::vector<std::string> laws;  ///< that have it
};

/// Reports a constant of another law than the one that is given.
void check_constants(Reader& reader, const std::string& law) {
    const std::vector<ConstantOfLaws> constants = {
        {"bulk_modulus", {"mooney-rivlin", "yeoh", "ogden"}},
        {"c10", {"mooney-rivlin", "yeoh"}},
        {"c01", {"mooney-rivlin"}},
        {"c20", {"yeoh"}},
        {"c30", {"yeoh"}},
        {"mu", {"ogden"}},
        {"alpha", {"ogden"}},
        {"shape_parameter", {"shape-blend"}},
        {"stiffest", {"shape-blend"}},
        {"shape_curve", {"shape-blend"}},
    };
    for (const auto& [key, laws] : constants) {
        const bool fits = std::ranges::find(laws, law) != laws.end();
        if (fits) (void)reader.raw(key);  // known, even if what stands before it in the table was wrong
        if (!fits && reader.has(key))
            reader.problem(key, fmt::format("is a constant of {}; the law here is {}", join_names(laws), law));
    }
}

/// Larger numbers overflow when they are multiplied; no material comes near them.
constexpr double most_Pa = 1e18, most_density_kg_m3 = 1e9;

/// The key that is to blame for a modulus that is too large.
std::string_view modulus_key(Reader& reader, const std::string& law) {
    if (reader.has("youngs_modulus")) return "youngs_modulus";
    return law == "ogden" ? "mu" : "c10";
}

void check_size(Reader& reader, const std::string& law, const MaterialSpec& material) {
    const double E = material.youngs_modulus_Pa;
    if (E > 0 && !(E <= most_Pa))
        reader.problem(
            modulus_key(reader, law),
            fmt::format("{:.3g} Pa is not possible; diamond has 1e12, and at most {:.0e} are taken", E, most_Pa));
    else if (reader.has("bulk_modulus") && !(material::moduli(material.law).bulk_Pa <= most_Pa))
        reader.problem("bulk_modulus", fmt::format("is not possible; at most {:.0e} Pa are taken", most_Pa));
}

void read_elastic(Reader& reader, const std::string& law, MaterialSpec& material) {
    if (law == "mooney-rivlin" || law == "yeoh" || law == "ogden")
        read_hyperelastic(reader, law, material);
    else
        read_two_moduli(reader, law, material);
    check_constants(reader, law);
    check_size(reader, law, material);
}

}  // namespace

double read_exposure(Reader& reader, std::string_view key) {
    constexpr double least_s = 0.001, most_s = 3600;  // G-code has milliseconds
    if (!reader.has(key)) return (void)reader.raw(key), 0;
    const double seconds = reader.quantity(key, Dimension::time, 1);
    if (!(seconds >= least_s && seconds <= most_s)) reader.problem(key, "must be from a millisecond to an hour");
    return seconds;
}

MaterialSpec read_material(Reader& reader, const std::string& name) {
    MaterialSpec material;
    material.name = name;
    const std::string law = reader.choice(
        "law",
        {"neo-hookean", "mooney-rivlin", "yeoh", "ogden", "corotated", "st-venant-kirchhoff", "linear", "shape-blend"},
        "neo-hookean");
    if (reader.unreadable("law"))
        skip_keys(reader);  // which of them are right depends on the law
    else
        read_elastic(reader, law, material);
    material.density_kg_m3 = reader.quantity("density", Dimension::density, 1000);
    if (material.density_kg_m3 < 0) reader.problem("density", "must not be negative");
    if (!(material.density_kg_m3 <= most_density_kg_m3))
        reader.problem("density", fmt::format("{:.3g} kg/m^3 is not possible; osmium has 22600, and at most {:.0e} are "
                                              "taken",
                                              material.density_kg_m3, most_density_kg_m3));
    material.resin = reader.text("resin", name);
    material.colour = read_colour(reader);
    material.exposure_s = read_exposure(reader, "exposure");
    material.bottom_exposure_s = read_exposure(reader, "bottom_exposure");
    return material;
}

}  // namespace pliant::robot
