// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Where points start, at which liquid pressure and under which stress.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <vadose/core/error.hpp>
#include <vadose/core/sym_tensor.hpp>
#include <vadose/grid/region.hpp>
#include <vadose/model/material.hpp>

namespace vadose {

/// A point at its start.
template <int Dim>
struct SeedPoint {
  Vec<Dim> position;  ///< [m]
  Real volume;        ///< [m^dim]; the factor r of axisymmetry is not in it
};

/// Lattice of points: every cell of size h from `origin` on is cut into k^dim equal parts with one
/// point in the middle of each.
template <int Dim>
struct Lattice {
  Vec<Dim> origin;         ///< corner of the grid [m]
  Real cell_size = unset;  ///< h [m]
  int per_axis = 2;        ///< k [-], >= 1

  /// Volume of one part [m^dim].
  Real volume() const { return power<Dim>(cell_size / per_axis); }
};

namespace detail {

/// Finaliser of the splitmix64 generator: a well-mixed function of its argument.
constexpr std::uint64_t mix(std::uint64_t z) noexcept {
  z += 0x9e3779b97f4a7c15ull;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

/// Number in [-1, 1) that depends on the seed, the lattice site and the axis only.
template <int Dim>
Real random_offset(std::uint64_t seed, const std::array<std::int64_t, Dim>& site, int axis) {
  std::uint64_t h = mix(seed);
  for (const std::int64_t i : site) h = mix(h ^ static_cast<std::uint64_t>(i));
  h = mix(h ^ static_cast<std::uint64_t>(axis));
  return static_cast<Real>(h >> 11) * 0x1p-52 - 1;
}

}  // namespace detail

/// Calls f(position, site) for the lattice points inside the region, x fastest; f returns false to
/// stop. The region must be bounded.
template <int Dim, class F>
void for_each_site(const Region<Dim>& region, const Lattice<Dim>& lattice, F&& f) {
  const Box<Dim>& bounds = region.bounding_box();
  const Real spacing = lattice.cell_size / lattice.per_axis;
  std::array<std::int64_t, Dim> first{}, last{};
  if (bounds.empty()) return;
  for (int d = 0; d < Dim; ++d) {
    check::finite("region low " + check::axis_name(d), bounds.low[d], "m");
    check::finite("region high " + check::axis_name(d), bounds.high[d], "m");
    const auto u = static_cast<std::size_t>(d);
    first[u] =
        static_cast<std::int64_t>(std::floor((bounds.low[d] - lattice.origin[d]) / spacing)) - 1;
    last[u] =
        static_cast<std::int64_t>(std::ceil((bounds.high[d] - lattice.origin[d]) / spacing)) + 1;
  }
  auto site = first;
  while (true) {
    Vec<Dim> x;
    for (int d = 0; d < Dim; ++d)
      x[d] = lattice.origin[d] +
             lattice.cell_size *
                 ((static_cast<Real>(site[static_cast<std::size_t>(d)]) + 0.5) / lattice.per_axis);
    if (region.contains(x) && !f(x, site)) return;
    std::size_t d = 0;
    while (d < Dim && ++site[d] > last[d]) site[d] = first[d], ++d;
    if (d == Dim) return;
  }
}

/// Points of the lattice inside the region, each with the volume of its part. With `jitter`
/// (fraction of the cell size, at most 1 / (2 k)) every coordinate is moved by a number evenly
/// distributed in +- jitter x h that depends on the seed and the lattice site only; membership is
/// decided before.
template <int Dim>
std::vector<SeedPoint<Dim>> seed(const Region<Dim>& region, const Vec<Dim>& origin, Real cell_size,
                                 int per_axis, Real jitter = 0, std::uint64_t random_seed = 0) {
  check::positive("cell_size", cell_size, "m");
  if (per_axis < 1) check::fail("points per axis and cell", per_axis, "[1, inf)", "-");
  check::within("jitter", jitter, 0, 0.5 / per_axis, "cell size");
  const Lattice<Dim> lattice{origin, cell_size, per_axis};
  std::vector<SeedPoint<Dim>> points;
  for_each_site(region, lattice, [&](Vec<Dim> x, const std::array<std::int64_t, Dim>& site) {
    for (int d = 0; jitter > 0 && d < Dim; ++d)
      x[d] += jitter * cell_size * detail::random_offset<Dim>(random_seed, site, d);
    points.push_back({x, lattice.volume()});
    return true;
  });
  return points;
}

/// Some lattice point is inside the region.
template <int Dim>
bool has_points(const Region<Dim>& region, const Lattice<Dim>& lattice) {
  bool found = false;
  for_each_site(region, lattice, [&](const Vec<Dim>&, const auto&) {
    found = true;
    return false;
  });
  return found;
}

/// Raises SetupError if a lattice point of one region is inside the other. The names tell the
/// regions apart in the message.
template <int Dim>
void check_disjoint(const std::string& name_a, const Region<Dim>& a, const Lattice<Dim>& lattice_a,
                    const std::string& name_b, const Region<Dim>& b,
                    const Lattice<Dim>& lattice_b) {
  if ((a.bounding_box() & b.bounding_box()).empty()) return;
  const Region<Dim> common = a & b;
  const auto refuse = [&](const Vec<Dim>& x, const auto&) -> bool {
    std::string at;
    for (int d = 0; d < Dim; ++d) at += (d ? ", " : "") + check::text(x[d]);
    throw SetupError("region of " + name_a + " overlaps region of " + name_b + " at (" + at +
                     ") [m], allowed: disjoint regions");
  };
  for_each_site(common, lattice_a, refuse);
  for_each_site(common, lattice_b, refuse);
}

/// Height of x above the origin, against gravity [m]. Gravity must not be zero.
template <int Dim>
Real height(const Vec<Dim>& x, const Vec<Dim>& gravity) {
  return -x.dot(gravity) / gravity.norm();
}

/// Pressure of a liquid at rest: p = rho_l |g| (level - height) [Pa], negative above the level.
template <int Dim>
Real hydrostatic_pressure(const Vec<Dim>& x, Real level, Real liquid_density,
                          const Vec<Dim>& gravity) {
  return liquid_density * gravity.norm() * (level - height(x, gravity));
}

/// Liquid pressure [Pa], compression +, at a position [m].
template <int Dim>
using PressureFunction = std::function<Real(const Vec<Dim>&)>;

/// Stress of the skeleton at the start.
enum class InitialStress : unsigned char {
  none,       ///< Bishop stress 0
  geostatic,  ///< from the weight of what lies above, see InitialState::bishop_stress
};

/// How a body of soil starts. Unsaturated models need exactly one of suction, saturation,
/// water_table, liquid_pressure and dry; saturated ones take water_table or liquid_pressure
/// (neither: pressure 0); dry ones none of them.
template <int Dim>
struct SoilOptions {
  int points_per_cell = 1 << Dim;  ///< k^Dim with k = 1 to 8 [-]
  Real jitter = 0;           ///< random offset of each coordinate [cell size], in [0, 1 / (2 k)]
  std::uint64_t seed = 0;    ///< of the random offsets
  Real suction = unset;      ///< uniform suction [Pa], >= 0
  Real saturation = unset;   ///< uniform degree of saturation [-], in (S_res, 1]
  Real water_table = unset;  ///< height of p = 0 above the origin, against gravity [m]
  PressureFunction<Dim> liquid_pressure = {};          ///< p(x) [Pa], compression +
  bool dry = false;                                    ///< no water at all at the start
  Vec<Dim> velocity = Vec<Dim>::Zero();                ///< of skeleton and pore water [m/s]
  InitialStress initial_stress = InitialStress::none;  ///< at the start
  /// K_0 = horizontal / vertical Bishop stress of a geostatic start [-], in [0, 10]; by default
  /// nu / (1 - nu), that of an elastic skeleton without lateral strain.
  Real lateral_stress_ratio = unset;
};

/// How a body of free water starts. Without surface_level and liquid_pressure: pressure 0.
template <int Dim>
struct WaterOptions {
  int points_per_cell = 1 << Dim;  ///< k^Dim with k = 1 to 8 [-]
  Real jitter = 0;             ///< random offset of each coordinate [cell size], in [0, 1 / (2 k)]
  std::uint64_t seed = 0;      ///< of the random offsets
  Real surface_level = unset;  ///< height of p = 0 above the origin, against gravity [m]
  PressureFunction<Dim> liquid_pressure = {};  ///< p(x) [Pa], compression +
  Vec<Dim> velocity = Vec<Dim>::Zero();        ///< [m/s]
};

/// Soil in a scene.
template <int Dim>
struct SoilBody {
  Region<Dim> region;        ///< where it is
  int material;              ///< index into Scene::materials()
  SoilOptions<Dim> options;  ///< how it starts
  Lattice<Dim> lattice;      ///< of its points
};

/// Free water in a scene.
template <int Dim>
struct WaterBody {
  Region<Dim> region;         ///< where it is
  WaterOptions<Dim> options;  ///< how it starts
  Lattice<Dim> lattice;       ///< of its points
};

namespace detail {

/// Poisson's ratio of a law that has one, else unset.
template <class Law>
Real poisson_ratio_of(const Law& law) {
  if constexpr (requires { static_cast<Real>(law.poisson_ratio); })
    return law.poisson_ratio;
  else if constexpr (requires { static_cast<Real>(law.elastic.poisson_ratio); })
    return law.elastic.poisson_ratio;
  else
    return unset;
}

/// vertical along `up`, horizontal across it.
template <int N, int Dim>
SymTensor<Real, N> cross_isotropic(Real vertical, Real horizontal, const Vec<Dim>& up) {
  SymTensor<Real, N> stress;
  stress.add_isotropic(horizontal);
  for (int d = 0; d < Dim; ++d) stress[d] += (vertical - horizontal) * up[d] * up[d];
  for (int i = 3; i < N; ++i)
    stress[i] = (vertical - horizontal) * up[(i - 3) % Dim] * up[(i - 2) % Dim];
  return stress;
}

}  // namespace detail

template <class M>
class Scene;

/// Start values at any position, computed from a scene (which must outlive it, unchanged). `soil`
/// and `water` are indices into Scene::soils() and Scene::waters().
template <class M>
class InitialState {
 public:
  static constexpr int dim = M::Kinematics::dim;
  static constexpr int stress_size = M::Kinematics::stress_size;

  /// Start values of a scene.
  explicit InitialState(const Scene<M>& scene) : scene_(&scene) {
    for (const auto& soil : scene.soils()) {
      const Material<M>& material = materials_.emplace_back(scene.material(soil.material));
      const Real pressure = uniform_pressure(soil.options, material);
      uniform_.push_back({pressure, saturation_at(pressure, material)});
    }
  }

  /// Pore liquid pressure [Pa], compression +; 0 where the soil starts dry.
  Real liquid_pressure(int soil, const Vec<dim>& x) const {
    const auto i = static_cast<std::size_t>(soil);
    const SoilOptions<dim>& o = scene_->soils()[i].options;
    if (o.liquid_pressure) return o.liquid_pressure(x);
    if (o.water_table == o.water_table)
      return hydrostatic_pressure(x, o.water_table, scene_->liquid.density, scene_->gravity);
    return uniform_[i].pressure;
  }

  /// Degree of saturation [-]: 0 where the soil starts dry.
  Real saturation(int soil, const Vec<dim>& x) const {
    const auto i = static_cast<std::size_t>(soil);
    const SoilOptions<dim>& o = scene_->soils()[i].options;
    if (!has_liquid<M> || o.dry) return 0;
    if (!o.liquid_pressure && o.water_table != o.water_table) return uniform_[i].saturation;
    return saturation_at(liquid_pressure(soil, x), materials_[i]);
  }

  /// Pressure of free water [Pa], compression +.
  Real water_pressure(int water, const Vec<dim>& x) const {
    const WaterOptions<dim>& o = scene_->waters()[static_cast<std::size_t>(water)].options;
    if (o.liquid_pressure) return o.liquid_pressure(x);
    if (o.surface_level == o.surface_level)
      return hydrostatic_pressure(x, o.surface_level, scene_->liquid.density, scene_->gravity);
    return 0;
  }

  /// Bishop stress [Pa], tension +: sigma* = sigma + S p I. Geostatic: along gravity the total
  /// stress carries the weight of soil and free water above x inside the domain, across gravity
  /// sigma* is K_0 times that along it. Exact for level layers; elsewhere a first guess.
  SymTensor<Real, stress_size> bishop_stress(int soil, const Vec<dim>& x) const {
    const SoilOptions<dim>& o = scene_->soils()[static_cast<std::size_t>(soil)].options;
    if (o.initial_stress == InitialStress::none) return {};
    const Real vertical = saturation(soil, x) * liquid_pressure(soil, x) - overburden(x);
    return detail::cross_isotropic<stress_size, dim>(
        vertical, lateral_stress_ratio(soil) * vertical,
        Vec<dim>(-scene_->gravity / scene_->gravity.norm()));
  }

  /// K_0 [-]: as given, else nu / (1 - nu); NaN where the law has no Poisson's ratio.
  Real lateral_stress_ratio(int soil) const {
    const auto i = static_cast<std::size_t>(soil);
    const Real given = scene_->soils()[i].options.lateral_stress_ratio;
    if (given == given) return given;
    const Real nu = detail::poisson_ratio_of(materials_[i].skeleton);
    return nu / (1 - nu);
  }

  /// Weight per area of everything above x in the domain [Pa].
  Real overburden(const Vec<dim>& x) const {
    const Vec<dim> up = -scene_->gravity / scene_->gravity.norm();
    const Real top = distance_to_boundary(x, up);
    const Real step = scene_->cell_size() / 4;
    Real mass = 0;
    Real from = 0;
    Body at = body(x);
    while (from < top) {
      const Real to = std::min(from + step, top);
      const Body next = body(x + to * up);
      const Real change = next == at ? to : change_between(x, up, at, from, to);
      mass += density(at, x + (from + change) / 2 * up) * (change - from);
      mass += density(next, x + (change + to) / 2 * up) * (to - change);
      from = to;
      at = next;
    }
    return mass * scene_->gravity.norm();
  }

 private:
  /// Soil (>= 0), water (-2 - index) or nothing (-1).
  using Body = int;

  /// What is the same all over a soil; asked for very often where the weight above is summed.
  struct Uniform {
    Real pressure = 0;    ///< [Pa]
    Real saturation = 0;  ///< [-]
  };

  static Real uniform_pressure(const SoilOptions<dim>& o, const Material<M>& material) {
    if constexpr (is_unsaturated<M>) {
      if (o.suction == o.suction) return -o.suction;
      if (o.saturation == o.saturation)
        return -swrc::suction(material.retention, o.saturation, material.porosity);
    }
    return 0;
  }

  static Real saturation_at(Real pressure, const Material<M>& material) {
    if constexpr (is_unsaturated<M> && has_skeleton<M>)
      return swrc::saturation<Real>(material.retention, std::max(Real(0), -pressure),
                                    material.porosity);
    else
      return 1;
  }

  Real distance_to_boundary(const Vec<dim>& x, const Vec<dim>& up) const {
    Real distance = std::numeric_limits<Real>::infinity();
    for (int d = 0; d < dim; ++d) {
      if (up[d] == 0) continue;
      const Real end = up[d] > 0 ? scene_->box().high[d] : scene_->box().low[d];
      distance = std::min(distance, std::max(Real(0), (end - x[d]) / up[d]));
    }
    return distance;
  }

  Body body(const Vec<dim>& x) const {
    for (std::size_t i = 0; i < scene_->soils().size(); ++i)
      if (scene_->soils()[i].region.contains(x)) return static_cast<Body>(i);
    for (std::size_t i = 0; i < scene_->waters().size(); ++i)
      if (scene_->waters()[i].region.contains(x)) return -2 - static_cast<Body>(i);
    return -1;
  }

  /// Distance between `from` and `to` at which body `at` ends, by bisection.
  Real change_between(const Vec<dim>& x, const Vec<dim>& up, Body at, Real from, Real to) const {
    for (int i = 0; i < 45; ++i) {
      const Real middle = (from + to) / 2;
      (body(x + middle * up) == at ? from : to) = middle;
    }
    return (from + to) / 2;
  }

  /// Density of grains and water together [kg/m3].
  Real density(Body at, const Vec<dim>& x) const {
    if (at == -1) return 0;
    if (at < -1) return scene_->liquid.density;
    const Material<M>& m = materials_[static_cast<std::size_t>(at)];
    const Real water = has_liquid<M> ? scene_->liquid.density * saturation(at, x) : 0;
    return (1 - m.porosity) * m.solid_density + m.porosity * water;
  }

  const Scene<M>* scene_;
  std::vector<Material<M>> materials_;
  std::vector<Uniform> uniform_;  ///< of soils that start with one pressure
};

}  // namespace vadose
