#include "simulation/peers/calculix_deck.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <span>
#include <type_traits>

#include "base/core/letters.hpp"
#include "geometry/files/tet_writer.hpp"

namespace pliant::sim::calculix {
namespace {

constexpr double mm_per_m = 1e3;
constexpr double uN_per_N = 1e6;
constexpr double g_per_mm3 = 1e-6;  ///< kg/m^3 in g/mm^3: a force in uN is g mm/s^2
/// The nodes of a rotating support move along the chord of their arc: beyond this angle they would come too close
/// together.
constexpr double most_turn_rad = std::numbers::pi / 3 + 1e-9;
/// Range of the ramped springs: far more than a cable can stretch or shrink, so that ccx never extrapolates.
constexpr double spring_range_mm = 1e5;

/// For the terms (J - 1)^(2i) / D_i that our laws lack. Zeros do not disable them: they made a bar 2 % stiffer.
constexpr double no_more_D = 1e20;

/// CalculiX' number of the face opposite to a corner: its faces are 1-2-3, 1-4-2, 2-4-3, 3-4-1.
constexpr std::array<int, 4> face_opposite_to = {3, 4, 2, 1};

using Out = std::back_insert_iterator<std::string>;

/// 2/K, the parameter of CalculiX.
double d1(double bulk_Pa) {
    return 2 / (bulk_Pa);
}

/// mu and alpha of every term, D1, and the higher D without effect; at most eight numbers per line.
Status write_ogden(Out out, const material::Ogden& law) {
    if (law.terms > 4) return input_error("CalculiX: an Ogden law of at most 4 terms, not {}", law.terms);
    std::vector<double> numbers;
    for (std::size_t k = 0; k < static_cast<std::size_t>(law.terms); ++k)
        numbers.insert(numbers.end(), {law.mu_Pa[k], law.alpha[k]});
    numbers.push_back(d1(law.bulk_Pa));
    numbers.resize(3 * static_cast<std::size_t>(law.terms), no_more_D);
    fmt::format_to(out, "*HYPERELASTIC,OGDEN,N={}", law.terms);
    for (std::size_t k = 0; k < numbers.size(); ++k)
        fmt::format_to(out, "{}{:.10g}", k % 8 == 0 ? "\n" : ",", numbers[k]);
    fmt::format_to(out, "\n");
    return {};
}

Status write_law(Out out, const material::Law& any) {
    return std::visit(
        [&](const auto& law) -> Status {
            using L = std::decay_t<decltype(law)>;
            if constexpr (std::is_same_v<L, material::NeoHookean>) {
                fmt::format_to(out, "*HYPERELASTIC,NEO HOOKE\n{:.10g},{:.10g}\n", law.shear_Pa / 2, d1(law.bulk_Pa));
            } else if constexpr (std::is_same_v<L, material::MooneyRivlin>) {
                fmt::format_to(out, "*HYPERELASTIC,MOONEY-RIVLIN\n{:.10g},{:.10g},{:.10g}\n", law.c10_Pa, law.c01_Pa,
                               d1(law.bulk_Pa));
            } else if constexpr (std::is_same_v<L, material::Yeoh>) {
                fmt::format_to(out, "*HYPERELASTIC,YEOH\n{:.10g},{:.10g},{:.10g},{:.10g},{:.10g},{:.10g}\n", law.c10_Pa,
                               law.c20_Pa, law.c30_Pa, d1(law.bulk_Pa), no_more_D, no_more_D);
            } else if constexpr (std::is_same_v<L, material::Ogden>) {
                return write_ogden(out, law);
            } else if constexpr (std::is_same_v<L, material::StVenantKirchhoff>) {
                const material::Moduli m = material::moduli(any);
                fmt::format_to(out, "*ELASTIC\n{:.10g},{:.10g}\n", material::youngs_modulus(m),
                               material::poisson_ratio(m));
            } else {
                return input_error("CalculiX has no counterpart of the law {}", material::name(any));
            }
            return {};
        },
        any);
}

/// 0, 1 or 2 if a direction is along an axis, else -1.
int axis_of(const Vec3& direction) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (std::fabs(direction[axis]) == norm(direction)) return static_cast<int>(axis);
    }
    return -1;
}

bool holds(const Support& support, int axis) {
    return support.directions.empty() || std::any_of(support.directions.begin(), support.directions.end(),
                                                     [&](const Vec3& direction) { return axis_of(direction) == axis; });
}

class DeckWriter {
public:
    DeckWriter(const Description& description, double end, const Effort& effort)
        : d_(description), end_(end), effort_(effort) {}

    Result<std::string> write() {
        for (const auto part :
             {&DeckWriter::check, &DeckWriter::head, &DeckWriter::mesh, &DeckWriter::materials, &DeckWriter::supports,
              &DeckWriter::springs, &DeckWriter::step, &DeckWriter::pressures}) {
            if (Status done = (this->*part)(); !done) return tl::unexpected(done.error());
        }
        line("*NODE PRINT,NSET=ALL,FREQUENCY=100000\nU,RF\n*NODE FILE\nU,RF\n*EL FILE\nS\n*END STEP");
        return std::move(text_);
    }

private:
    template <class... Args>
    void line(fmt::format_string<Args...> text, Args&&... args) {
        fmt::format_to(out_, text, std::forward<Args>(args)...);
        text_ += '\n';
    }

    Status check() {
        // Deferred self-contact is left out: a deck is for robots that do not meet themselves.
        if (d_.contact && !(d_.contact->self_when_met && d_.contact->obstacles.empty()))
            return input_error("CalculiX: the deck has no contact; leave [contact] and obstacles out");
        if (!d_.growths.empty() || !d_.plates.empty())
            return input_error("CalculiX: the deck has no gap-elements, expanding elements or rigid plates");
        if (!d_.springs.empty()) return input_error("CalculiX: the deck has no springs; leave [[spring]] out");
        if (!d_.torques.empty()) return input_error("CalculiX: the deck has no torques; leave torque out of the loads");
        if (d_.fluid) return input_error("CalculiX: the deck has no fluid; leave [fluid] out");
        if (!d_.masses.empty()) return input_error("CalculiX: the deck has no masses; leave [[mass]] out");
        if (!d_.joints.empty()) return input_error("CalculiX: the deck has no joints; leave [[joint]] out");
        if (!d_.objects.empty()) return input_error("CalculiX: the deck has no objects; leave [[object]] out");
        if (d_.moves_in_time)
            return input_error("CalculiX: the deck is an equilibrium, not a motion in time; leave time_step out");
        if (!d_.material_of_tet.empty())
            return input_error(
                "CalculiX: the deck has no bodies that change from one material to another; leave blend out");
        for (const Support& support : d_.supports) {
            if (std::fabs(support.turn.angle_rad * support.share.at(end_)) > most_turn_rad)
                return input_error("CalculiX: support \"{}\" turns by more than 60 degrees", support.name);
            for (const Vec3& direction : support.directions) {
                if (axis_of(direction) < 0)
                    return input_error("CalculiX: support \"{}\" holds a direction that is not x, y or z",
                                       support.name);
            }
        }
        for (const Cable& cable : d_.cables) {
            if (cable.target.kind != CableTarget::Kind::tension_N)
                return input_error(
                    "CalculiX: cable \"{0}\" must be driven by its tension: take what simulate reports, as in "
                    "--set 'cable.{0}.target={{tension=\"8 N\"}}'",
                    cable.name);
            if (cable.friction != 0) return input_error("CalculiX: cable \"{}\" must be without friction", cable.name);
        }
        for (const Chamber& chamber : d_.chambers) {
            if (chamber.target.kind != ChamberTarget::Kind::pressure_Pa)
                return input_error(
                    "CalculiX: chamber \"{0}\" must be driven by its pressure: take what simulate reports, as in "
                    "--set 'chamber.{0}.target={{pressure=\"40 kPa\"}}'",
                    chamber.name);
        }
        return {};
    }

    Status head() {
        line("*HEADING\nrobot of pliant: mm, uN, Pa, g; displacements and forces at the end of the program");
        text_ += mesh::inp_name_comments(d_.mesh.region_names);
        return {};
    }

    void node(const Vec3& p) {
        ++nodes_;
        line("{},{:.12g},{:.12g},{:.12g}", nodes_, p.x * mm_per_m, p.y * mm_per_m, p.z * mm_per_m);
    }

    Status mesh() {
        line("*NODE,NSET=ALL");
        for (const Vec3& p : d_.mesh.points) node(p);
        for (std::size_t r = 0; r < d_.material_of_region.size(); ++r) {
            line("*ELEMENT,TYPE={},ELSET={}", d_.mesh.order == 2 ? "C3D10" : "C3D4", label(r));
            for (std::size_t t = 0; t < d_.mesh.tet_count(); ++t) {
                if (d_.mesh.region[t] != static_cast<int>(r)) continue;
                fmt::format_to(out_, "{}", t + 1);
                for (const int n : d_.mesh.tet(t)) fmt::format_to(out_, ",{}", n + 1);
                text_ += '\n';
            }
        }
        return {};
    }

    /// The element set of a region. Robots built in code may have fewer names than regions.
    [[nodiscard]] std::string label(std::size_t region) const {
        const std::vector<std::string> labels = mesh::inp_labels(d_.mesh.region_names);
        return region < labels.size() ? labels[region] : fmt::format("R{}", region + 1);
    }

    /// CABLE1, or what no region is called: the sets of both are of elements, and their names have no case.
    [[nodiscard]] std::string cable_set(std::size_t cable) const {
        std::string set = fmt::format("CABLE{}", cable + 1);
        const std::vector<std::string> labels = mesh::inp_labels(d_.mesh.region_names);
        const auto is_taken = [&](const std::string& label) { return lower_case(label) == lower_case(set); };
        while (std::any_of(labels.begin(), labels.end(), is_taken)) set += '_';
        return set;
    }

    Status materials() {
        for (std::size_t m = 0; m < d_.materials.size(); ++m) {
            line("** material \"{}\"\n*MATERIAL,NAME=M{}", d_.materials[m].name, m + 1);
            if (Status done = write_law(out_, d_.materials[m].law); !done) return done;
            if (norm(d_.gravity_m_s2) > 0) line("*DENSITY\n{:.10g}", g_per_mm3 * d_.materials[m].density_kg_m3);
        }
        for (std::size_t r = 0; r < d_.material_of_region.size(); ++r)
            line("*SOLID SECTION,ELSET={},MATERIAL=M{}", label(r), d_.material_of_region[r] + 1);
        return {};
    }

    Status supports() {
        for (std::size_t s = 0; s < d_.supports.size(); ++s) {
            line("** support \"{}\"\n*NSET,NSET=S{}", d_.supports[s].name, s + 1);
            for (const int n : d_.supports[s].nodes) line("{},", n + 1);
        }
        return {};
    }

    /// Node of a cable's point, 1-based: a node of the mesh, one fixed in space, or one attached to several.
    int cable_node(const Attachment& point) {
        if (point.nodes.size() == 1) return point.nodes[0] + 1;
        line("*NODE");
        if (point.nodes.empty()) {
            node(point.fixed);
            anchors_.push_back(nodes_);
            return nodes_;
        }
        Vec3 rest = point.fixed;
        for (std::size_t k = 0; k < point.nodes.size(); ++k)
            rest += point.weights[k] * d_.mesh.points[static_cast<std::size_t>(point.nodes[k])];
        node(rest);
        for (int direction = 1; direction <= 3; ++direction) tie(nodes_, direction, point);
        return nodes_;
    }

    /// Ties the node to the weighted mean of the nodes that carry it.
    void tie(int rider, int direction, const Attachment& point) {
        constexpr int per_line = 4;
        const auto terms =
            1 + std::count_if(point.weights.begin(), point.weights.end(), [](double w) { return w != 0; });
        line("*EQUATION\n{}", terms);
        fmt::format_to(out_, "{},{},1.", rider, direction);
        int written = 1;
        for (std::size_t k = 0; k < point.nodes.size(); ++k) {
            if (point.weights[k] == 0) continue;
            fmt::format_to(out_, "{}{},{},{:#.10g}", written % per_line == 0 ? "\n" : ",", point.nodes[k] + 1,
                           direction, -point.weights[k]);
            ++written;
        }
        text_ += '\n';
    }

    /// A segment as a spring with constant force at any length; the force is ramped with the temperature, from 0 to 1.
    Status springs() {
        int element = static_cast<int>(d_.mesh.tet_count());
        for (std::size_t c = 0; c < d_.cables.size(); ++c) {
            const CableTarget& target = d_.cables[c].target;
            const double tension = uN_per_N * (target.at(end_) + target.offset_at(end_));
            if (!(tension > 0)) continue;  // it is slack: a cable does not push
            std::vector<int> path;
            for (const Attachment& point : d_.cables[c].points) {
                path.push_back(cable_node(point));
                sprung_.push_back(path.back());
            }
            const std::string set = cable_set(c);
            line("** cable \"{}\"\n*ELEMENT,TYPE=SPRINGA,ELSET={}", d_.cables[c].name, set);
            for (std::size_t s = 1; s < path.size(); ++s) line("{},{},{}", ++element, path[s - 1], path[s]);
            line("*SPRING,NONLINEAR,ELSET={}", set);
            for (const double share : {0.0, 1.0}) {
                for (const double elongation : {-spring_range_mm, spring_range_mm})
                    line("{:#.10g},{:#.10g},{:#.10g}", share * tension, elongation, share);
            }
        }
        if (sprung_.empty()) return {};
        line("*INITIAL CONDITIONS,TYPE=TEMPERATURE");
        for (const int n : sprung_) line("{},0.", n);
        return {};
    }

    Status step() {
        for (const int n : anchors_) line("*BOUNDARY\n{},1,3", n);
        line("*STEP,NLGEOM,INC=1000\n*STATIC\n{:.10g},1.", effort_.first_increment);
        // Both residual limits: ccx takes the second, 2 % if nothing is said, once it has tried a number of times. It
        // has no stiffness of following pressures and then needs many more iterations than it allows itself.
        line("*CONTROLS,PARAMETERS=TIME INCREMENTATION\n20,40,60,60,30,10,,5");
        line("*CONTROLS,PARAMETERS=FIELD\n{0:.3g},{0:.3g},,,{0:.3g},,,", effort_.tolerance);
        if (!d_.supports.empty()) line("*BOUNDARY");
        for (const Support& support : d_.supports) {
            for (const int n : support.nodes) {
                const Vec3& rest = d_.mesh.points[static_cast<std::size_t>(n)];
                const Vec3 move = mm_per_m * (support.position(rest, support.share.at(end_)) - rest);
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    if (holds(support, static_cast<int>(axis)))
                        line("{0},{1},{1},{2:.12g}", n + 1, axis + 1, move[axis]);
                }
            }
        }
        if (!d_.loads.empty()) line("*CLOAD");
        for (const Load& load : d_.loads) {
            for (std::size_t k = 0; k < load.nodes.size(); ++k) {
                const Vec3 f = load.share.at(end_) * load.shares[k] * uN_per_N * load.force_N;
                line("{0},1,{1:.12g}\n{0},2,{2:.12g}\n{0},3,{3:.12g}", load.nodes[k] + 1, f.x, f.y, f.z);
            }
        }
        if (!sprung_.empty()) line("*TEMPERATURE");
        for (const int n : sprung_) line("{},1.", n);
        weigh();
        return {};
    }

    void weigh() {
        const Vec3 g = d_.gravity_share.at(end_) * mm_per_m * d_.gravity_m_s2;
        const double size = norm(g);
        if (size == 0) return;
        for (std::size_t r = 0; r < d_.material_of_region.size(); ++r)
            line("*DLOAD\n{},GRAV,{:.12g},{:#.10g},{:#.10g},{:#.10g}", label(r), size, g.x / size, g.y / size,
                 g.z / size);
    }

    Status pressures() {
        if (d_.chambers.empty() && d_.pressures.empty()) return {};
        for (const mesh::Face& face : mesh::boundary_faces(d_.mesh)) {
            std::array<int, 3> corners = {face.nodes[0], face.nodes[1], face.nodes[2]};
            std::sort(corners.begin(), corners.end());
            const auto tet = d_.mesh.tet(static_cast<std::size_t>(face.tet));
            std::size_t opposite = 0;
            while (std::find(corners.begin(), corners.end(), tet[opposite]) != corners.end()) ++opposite;
            outer_[corners] = {face.tet, face_opposite_to[opposite]};
        }
        line("*DLOAD");
        for (const Chamber& chamber : d_.chambers) {
            if (Status done = press(chamber.name, chamber.wall, chamber.target.at(end_) + chamber.target.offset); !done)
                return done;
        }
        for (const PressureLoad& load : d_.pressures) {
            if (Status done = press(load.name, load.wall, load.pressure_Pa * load.share.at(end_)); !done) return done;
        }
        return {};
    }

    Status press(const std::string& name, const Wall& wall, double pressure_Pa) {
        // At a mouth the air presses on the support.
        for (const WallFace& face : wall.faces_of_bodies()) {
            std::array<int, 3> corners{};
            for (std::size_t k = 0; k < 3; ++k) {
                const Attachment& point = wall.points[static_cast<std::size_t>(face[k])];
                corners[k] = point.nodes.size() == 1 ? point.nodes[0] : -1;
            }
            std::sort(corners.begin(), corners.end());
            const auto found = outer_.find(corners);
            if (found == outer_.end())
                return input_error("CalculiX: the wall of {} does not lie on faces of the mesh", name);
            line("{},P{},{:.12g}", found->second[0] + 1, found->second[1], pressure_Pa);
        }
        return {};
    }

    const Description& d_;
    double end_;  ///< of the program, s
    const Effort& effort_;
    std::string text_;
    Out out_ = std::back_inserter(text_);
    int nodes_ = 0;
    std::vector<int> anchors_;
    std::vector<int> sprung_;
    std::map<std::array<int, 3>, std::array<int, 2>> outer_;  ///< corners of a face: its tet and CalculiX' number of it
};

}  // namespace

Result<std::string> deck(const Description& description, double duration, const Effort& effort) {
    return DeckWriter(description, duration, effort).write();
}

}  // namespace pliant::sim::calculix
