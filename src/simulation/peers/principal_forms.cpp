#include "simulation/peers/principal_forms.hpp"

#include <cmath>
#include <complex>
#include <type_traits>

namespace pliant::sim::reference {
namespace {

using Number = std::complex<double>;
using Energy = std::function<Number(std::array<Number, 3>)>;

/// I1_bar and I2_bar and J of three stretches.
struct Invariants {
    Number first, second, J;
};
Invariants invariants(const std::array<Number, 3>& l) {
    const Number J = l[0] * l[1] * l[2];
    const Number c[] = {l[0] * l[0], l[1] * l[1], l[2] * l[2]};
    return {std::pow(J, -2.0 / 3) * (c[0] + c[1] + c[2]),
            std::pow(J, -4.0 / 3) * (c[0] * c[1] + c[1] * c[2] + c[2] * c[0]), J};
}

Number volumetric(double bulk, const Number& J) {
    return bulk / 2 * (J - 1.0) * (J - 1.0);
}

Number psi(const material::NeoHookean& m, const std::array<Number, 3>& l) {
    const Invariants i = invariants(l);
    return m.shear_Pa / 2 * (i.first - 3.0) + volumetric(m.bulk_Pa, i.J);
}

Number psi(const material::MooneyRivlin& m, const std::array<Number, 3>& l) {
    const Invariants i = invariants(l);
    return m.c10_Pa * (i.first - 3.0) + m.c01_Pa * (i.second - 3.0) + volumetric(m.bulk_Pa, i.J);
}

Number psi(const material::Yeoh& m, const std::array<Number, 3>& l) {
    const Invariants i = invariants(l);
    const Number e = i.first - 3.0;
    return m.c10_Pa * e + m.c20_Pa * e * e + m.c30_Pa * e * e * e + volumetric(m.bulk_Pa, i.J);
}

Number psi(const material::Ogden& m, const std::array<Number, 3>& l) {
    const Number J = l[0] * l[1] * l[2];
    Number sum = volumetric(m.bulk_Pa, J);
    for (std::size_t k = 0; k < static_cast<std::size_t>(m.terms); ++k) {
        Number powers = -3.0;
        for (const Number& s : l) powers += std::pow(std::pow(J, -1.0 / 3) * s, m.alpha[k]);
        sum += 2 * m.mu_Pa[k] / (m.alpha[k] * m.alpha[k]) * powers;
    }
    return sum;
}

Number psi(const material::StVenantKirchhoff& m, const std::array<Number, 3>& l) {
    Number trace = 0, squares = 0;
    for (const Number& s : l) {
        const Number e = (s * s - 1.0) / 2.0;
        trace += e;
        squares += e * e;
    }
    return m.shear_Pa * squares + m.lame_Pa / 2 * trace * trace;
}

Number psi(const material::Corotated& m, const std::array<Number, 3>& l) {
    Number squares = 0;
    for (const Number& s : l) squares += (s - 1.0) * (s - 1.0);
    const Number J = l[0] * l[1] * l[2];
    return m.shear_Pa * squares + m.lame_Pa / 2 * (J - 1.0) * (J - 1.0);
}

/// Complex-step derivative, without cancellation: the imaginary part of f(x + ih) over h (Squire and Trapp, SIAM Review
/// 40, 1998).
constexpr double imaginary_step = 1e-30;

PrincipalForm from_energy(const material::Law& law, const Energy& energy) {
    PrincipalForm form;
    form.law = law;
    form.stress = [energy](Vec3 l) {
        Vec3 P;
        for (std::size_t i = 0; i < 3; ++i) {
            std::array<Number, 3> at = {l.x, l.y, l.z};
            at[i] += Number(0, imaginary_step);
            P[i] = energy(at).imag() / imaginary_step;
        }
        return P;
    };
    // Stretches of simple shear: s, 1/s, 1 with s - 1/s = g.
    form.shear_stress = [energy](double g) {
        const Number shear(g, imaginary_step);
        const Number s = shear / 2.0 + std::sqrt(1.0 + shear * shear / 4.0);
        return energy({s, 1.0 / s, 1.0}).imag() / imaginary_step;
    };
    return form;
}

/// Without an energy: P = w (F - a R - (1 - a) J^(-1/3) F); in simple shear R rotates by atan(g/2).
PrincipalForm blend_form(const material::ShapeBlend& m) {
    PrincipalForm form;
    form.law = m;
    form.stress = [m](Vec3 l) {
        const double back = std::pow(l.x * l.y * l.z, -1.0 / 3);
        const auto P = [&](double s) { return m.weight_Pa * (s - m.a - (1 - m.a) * back * s); };
        return Vec3{P(l.x), P(l.y), P(l.z)};
    };
    form.shear_stress = [m](double g) { return m.weight_Pa * m.a * (g - g / std::sqrt(4 + g * g)); };
    return form;
}

/// Linear in the stretches; simple shear has the strain g/2, and the only shear stress is mu g.
PrincipalForm linear_form(const material::Linear& m) {
    PrincipalForm form;
    form.law = m;
    form.stress = [m](Vec3 l) {
        const double pressure = m.lame_Pa * (l.x + l.y + l.z - 3);
        const auto P = [&](double s) { return 2 * m.shear_Pa * (s - 1) + pressure; };
        return Vec3{P(l.x), P(l.y), P(l.z)};
    };
    form.shear_stress = [m](double g) { return m.shear_Pa * g; };
    return form;
}

}  // namespace

PrincipalForm principal_form(const material::Law& law) {
    return std::visit(
        [&](const auto& m) -> PrincipalForm {
            using L = std::decay_t<decltype(m)>;
            if constexpr (std::is_same_v<L, material::ShapeBlend>) {
                return blend_form(m);
            } else if constexpr (std::is_same_v<L, material::Linear>) {
                return linear_form(m);
            } else {
                return from_energy(law, [m](std::array<Number, 3> l) { return psi(m, l); });
            }
        },
        law);
}

std::vector<PrincipalForm> principal_forms() {
    const double K = 2e6;
    const std::vector<material::Law> laws = {material::neo_hookean(1e6, 0.3),
                                             material::neo_hookean(1e6, 0.45),
                                             material::st_venant_kirchhoff(1e6, 0.3),
                                             material::corotated(1e6, 0.4),
                                             material::shape_blend(1e6, 0.3),
                                             material::linear(1e6, 0.4),
                                             material::MooneyRivlin{1e5, 0.7e5, K},
                                             material::Yeoh{1.7e5, -1e4, 2e3, K},
                                             material::Ogden{2, {2.5e5, 0.9e5}, {1.8, -2.5}, K}};
    std::vector<PrincipalForm> forms;
    forms.reserve(laws.size());
    for (const material::Law& law : laws) forms.push_back(principal_form(law));
    return forms;
}

double free_stretch(const PrincipalForm& form, const std::function<std::array<double, 3>(double)>& stretches_of) {
    double low = 0.3, high = 2;
    for (int i = 0; i < 100; ++i) {
        const double middle = (low + high) / 2;
        const auto l = stretches_of(middle);
        (form.stress({l[0], l[1], l[2]}).z > 0 ? high : low) = middle;
    }
    return low;
}

double slope(const PrincipalForm& form, std::array<double, 3> stretches, std::array<double, 3> rates) {
    const Vec3 P = form.stress({stretches[0], stretches[1], stretches[2]});
    return P.x * rates[0] + P.y * rates[1] + P.z * rates[2];
}

}  // namespace pliant::sim::reference
